// Curvature and features as what a file holds.

#include "server/fairway/result_attributes.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace fairway {
namespace {

bool is_identity(std::span<const Index> vertex, std::size_t count) {
  if (vertex.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    if (vertex[i] != i) return false;
  }
  return true;
}

/// Values of surface vertices as those of source vertices; 0 where `vertex` has none.
std::vector<float> spread(const std::vector<float>& values, std::size_t components,
                          std::span<const Index> vertex) {
  std::vector<float> out(components * vertex.size());
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    if (vertex[i] == kNoIndex) continue;
    std::copy_n(values.data() + components * vertex[i], components, out.data() + components * i);
  }
  return out;
}

struct Field {
  std::vector<float> CurvatureFloats::*values;
  int components;
};

Field field_of(CurvatureKind kind) {
  switch (kind) {
    case CurvatureKind::k1:
      return {&CurvatureFloats::k1, 1};
    case CurvatureKind::k2:
      return {&CurvatureFloats::k2, 1};
    case CurvatureKind::mean:
      return {&CurvatureFloats::mean, 1};
    case CurvatureKind::gaussian:
      return {&CurvatureFloats::gaussian, 1};
    case CurvatureKind::predominant:
      return {&CurvatureFloats::predominant, 1};
    case CurvatureKind::dir1:
      return {&CurvatureFloats::dir1, 3};
    case CurvatureKind::dir2:
      break;
  }
  return {&CurvatureFloats::dir2, 3};
}

void divide(std::vector<float>& values, double by) {
  constexpr double kMost = std::numeric_limits<float>::max();
  for (float& value : values) {
    value = static_cast<float>(std::clamp(static_cast<double>(value) / by, -kMost, kMost));
  }
}

/// Lengths grow by `scale`.
void scale_lengths(CurvatureFloats& fields, double scale) {
  for (auto* values : {&fields.k1, &fields.k2, &fields.mean, &fields.predominant}) {
    divide(*values, scale);
  }
  divide(fields.gaussian, scale * scale);
}

void add_colors(const CurvatureFloats& fields, std::span<const Index> vertex,
                const ColorOptions& colors, SurfaceResult& result, SurfaceReport& report) {
  report.color_limit = colors.limit.value_or(automatic_limit(fields.predominant));
  result.colors = {diverging_colours(spread(fields.predominant, 1, vertex), *report.color_limit),
                   colors.replace};
}

}  // namespace

void add_curvature(const Surface& surface, CurvatureFloats fields, std::span<const Index> vertex,
                   const CurvatureOutput& output, SurfaceResult& result, SurfaceReport& report) {
  if (output.space == CurvatureSpace::world) {
    const WorldScale& world = surface.world_scale;
    report.why_local = world.why_none;
    if (world.why_none.empty()) {
      report.world_scale = world.value;
      if (world.value != 1.0) scale_lengths(fields, world.value);
    }
  }
  if (output.colors) add_colors(fields, vertex, *output.colors, result, report);
  const bool same = is_identity(vertex, fields.k1.size());
  for (const CurvatureKind kind : output.kinds) {
    const auto [values, components] = field_of(kind);
    VertexAttribute attribute{std::string(attribute_name(kind)), components, {}};
    if (same) {
      attribute.values = std::move(fields.*values);
    } else {
      attribute.values = spread(fields.*values, static_cast<std::size_t>(components), vertex);
    }
    result.attributes.push_back(std::move(attribute));
  }
}

void add_zero_curvature(std::size_t vertices, const CurvatureOutput& output,
                        SurfaceResult& result) {
  for (const CurvatureKind kind : output.kinds) {
    const int components = field_of(kind).components;
    result.attributes.push_back(
        {std::string(attribute_name(kind)), components,
         std::vector<float>(static_cast<std::size_t>(components) * vertices)});
  }
}

/// float32, so that every reader takes it: bytes would have to stand four apart.
VertexAttribute feature_attribute(std::span<const unsigned char> flags) {
  VertexAttribute out{std::string(kFeatureAttribute), 1, {}};
  out.values.reserve(flags.size());
  for (const unsigned char flag : flags) out.values.push_back(flag != 0 ? 1.0F : 0.0F);
  return out;
}

}  // namespace fairway
