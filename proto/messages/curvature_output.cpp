// What is told of the curvature, as a part of the parameter document.

#include "proto/messages/curvature_output.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::array<std::string_view, 7> kCurvatureNames = {
    "k1", "k2", "mean", "gaussian", "predominant", "dir1", "dir2"};
constexpr std::array<std::string_view, 7> kAttributeNames = {
    "_CURVATURE_K1",          "_CURVATURE_K2",   "_CURVATURE_MEAN", "_CURVATURE_GAUSSIAN",
    "_CURVATURE_PREDOMINANT", "_CURVATURE_DIR1", "_CURVATURE_DIR2"};

constexpr std::array<Named<CurvatureSpace>, 2> kSpaces = {{
    {"local", CurvatureSpace::local},
    {"world", CurvatureSpace::world},
}};

std::vector<CurvatureKind> read_curvature(ObjectReader& reader) {
  std::vector<CurvatureKind> kinds;
  reader.strings("curvature", [&kinds](std::string_view name) -> std::string {
    for (std::size_t i = 0; i < kCurvatureNames.size(); ++i) {
      if (name != kCurvatureNames[i] && name != kAttributeNames[i]) continue;
      const auto kind = static_cast<CurvatureKind>(i);
      if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) return "is named twice";
      kinds.push_back(kind);
      return {};
    }
    return fmt::format("must be one of {}", fmt::join(kCurvatureNames, ", "));
  });
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

std::optional<ColorOptions> read_colors(ObjectReader& reader) {
  constexpr std::string_view kKey = "colors";
  if (!reader.holds_object(kKey)) {
    bool wanted = false;
    reader.boolean(kKey, wanted);
    return wanted ? std::optional(ColorOptions{}) : std::nullopt;
  }
  ColorOptions colors;
  ObjectReader child = reader.object(kKey);
  child.number_or_auto("limit", {1e-30, 1e30}, colors.limit);
  child.boolean("replace", colors.replace);
  reader.take_error(child);
  return colors;
}

Json colors_document(const std::optional<ColorOptions>& colors) {
  if (!colors) return false;
  return {{"limit", colors->limit ? Json(*colors->limit) : Json("auto")},
          {"replace", colors->replace}};
}

}  // namespace

std::string_view attribute_name(CurvatureKind kind) {
  return kAttributeNames[static_cast<std::size_t>(kind)];
}

CurvatureOutput read_curvature_output(ObjectReader& reader) {
  CurvatureOutput output;
  std::vector<CurvatureKind> kinds = read_curvature(reader);
  if (reader.holds("curvature")) output.kinds = std::move(kinds);
  reader.choice("curvature_space", std::span<const Named<CurvatureSpace>>(kSpaces), output.space);
  output.colors = read_colors(reader);
  return output;
}

void add_curvature_output(const CurvatureOutput& output, Json& document) {
  Json kinds = Json::array();
  for (const CurvatureKind kind : output.kinds) {
    kinds.push_back(kCurvatureNames[static_cast<std::size_t>(kind)]);
  }
  document["curvature"] = std::move(kinds);
  document["curvature_space"] = kSpaces[static_cast<std::size_t>(output.space)].name;
  document["colors"] = colors_document(output.colors);
}

}  // namespace fairway
