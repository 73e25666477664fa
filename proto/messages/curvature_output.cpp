// What is told of the curvature, as a part of the parameter document.

#include "proto/messages/curvature_output.h"

#include <array>

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

void read_curvature(ObjectReader& reader, std::vector<CurvatureKind>& kinds) {
  std::vector<std::size_t> chosen;
  chosen.reserve(kinds.size());
  for (const CurvatureKind kind : kinds) chosen.push_back(static_cast<std::size_t>(kind));
  reader.names("curvature", kCurvatureNames, kAttributeNames, chosen);
  kinds.clear();
  for (const std::size_t kind : chosen) kinds.push_back(static_cast<CurvatureKind>(kind));
}

std::optional<ColorOptions> read_colors(ObjectReader& reader) {
  constexpr std::string_view kKey = "colors";
  std::optional<ColorOptions> colors;
  const auto read = [&](ObjectReader& members) {
    ColorOptions given;
    members.number_or_auto("limit", {1e-30, 1e30}, given.limit);
    members.boolean("replace", given.replace);
    colors = given;
  };
  reader.object_or(kKey, read, [&] {
    bool wanted = false;
    reader.boolean(kKey, wanted);
    colors = wanted ? std::optional(ColorOptions{}) : std::nullopt;
  });
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
  read_curvature(reader, output.kinds);
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
