// Curvature and features as what a file holds.

#include "server/fairway/result_attributes.h"

#include <algorithm>
#include <limits>

namespace fairway {
namespace {

/// float32, finite: what lies beyond its range becomes its largest value.
float to_float(double value) {
  constexpr double kMost = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kMost, kMost));
}

/// Values of surface vertices as those of source vertices; 0 where `vertex` has none.
VertexAttribute scalar_attribute(CurvatureKind kind, const std::vector<double>& values,
                                 std::span<const Index> vertex) {
  VertexAttribute out{std::string(attribute_name(kind)), 1, std::vector<float>(vertex.size())};
  std::transform(vertex.begin(), vertex.end(), out.values.begin(),
                 [&values](Index v) { return v == kNoIndex ? 0.0F : to_float(values[v]); });
  return out;
}

VertexAttribute vector_attribute(CurvatureKind kind, const std::vector<Vec3>& values,
                                 std::span<const Index> vertex) {
  VertexAttribute out{std::string(attribute_name(kind)), 3, std::vector<float>(3 * vertex.size())};
  float* to = out.values.data();
  for (const Index v : vertex) {
    const Vec3 value = v == kNoIndex ? Vec3(Vec3::Zero()) : values[v];
    for (const double c : {value.x(), value.y(), value.z()}) *to++ = to_float(c);
  }
  return out;
}

VertexAttribute attribute(CurvatureKind kind, const CurvatureFields& fields,
                          std::span<const Index> vertex) {
  switch (kind) {
    case CurvatureKind::k1:
      return scalar_attribute(kind, fields.k1, vertex);
    case CurvatureKind::k2:
      return scalar_attribute(kind, fields.k2, vertex);
    case CurvatureKind::mean:
      return scalar_attribute(kind, fields.mean, vertex);
    case CurvatureKind::gaussian:
      return scalar_attribute(kind, fields.gaussian, vertex);
    case CurvatureKind::predominant:
      return scalar_attribute(kind, fields.predominant, vertex);
    case CurvatureKind::dir1:
      return vector_attribute(kind, fields.dir1, vertex);
    case CurvatureKind::dir2:
      break;
  }
  return vector_attribute(kind, fields.dir2, vertex);
}

void divide(std::vector<double>& values, double by) {
  for (double& value : values) value /= by;
}

/// Lengths grow by `scale`.
void scale_lengths(CurvatureFields& fields, double scale) {
  for (auto* values : {&fields.k1, &fields.k2, &fields.mean, &fields.predominant}) {
    divide(*values, scale);
  }
  divide(fields.gaussian, scale * scale);
}

void add_attributes(const CurvatureFields& fields, std::span<const Index> vertex,
                    const CurvatureOutput& output, SurfaceResult& result) {
  for (const CurvatureKind kind : output.kinds) {
    result.attributes.push_back(attribute(kind, fields, vertex));
  }
}

}  // namespace

void add_curvature(const Surface& surface, CurvatureFields fields, std::span<const Index> vertex,
                   const CurvatureOutput& output, SurfaceResult& result, SurfaceReport& report) {
  if (output.space == CurvatureSpace::world) {
    const WorldScale& world = surface.world_scale;
    report.why_local = world.why_none;
    if (world.why_none.empty()) {
      report.world_scale = world.value;
      if (world.value != 1.0) scale_lengths(fields, world.value);
    }
  }
  add_attributes(fields, vertex, output, result);
  if (!output.colors) return;
  report.color_limit = output.colors->limit.value_or(automatic_limit(fields.predominant));
  const VertexAttribute values =
      scalar_attribute(CurvatureKind::predominant, fields.predominant, vertex);
  result.colors = {diverging_colours(values.values, *report.color_limit), output.colors->replace};
}

void add_zero_curvature(std::size_t vertices, const CurvatureOutput& output,
                        SurfaceResult& result) {
  add_attributes({}, std::vector<Index>(vertices, kNoIndex), output, result);
}

/// float32, so that every reader takes it: bytes would have to stand four apart.
VertexAttribute feature_attribute(std::span<const unsigned char> flags) {
  VertexAttribute out{std::string(kFeatureAttribute), 1, {}};
  out.values.reserve(flags.size());
  for (const unsigned char flag : flags) out.values.push_back(flag != 0 ? 1.0F : 0.0F);
  return out;
}

}  // namespace fairway
