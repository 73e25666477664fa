#include "tests/fuzz/surface_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace fairway::test {
namespace {

struct Box {
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();
};

Box box_of(std::span<const Vec3> positions) {
  if (positions.empty()) return {};
  Box box{positions.front(), positions.front()};
  for (const Vec3& position : positions) {
    box.low = box.low.cwiseMin(position);
    box.high = box.high.cwiseMax(position);
  }
  return box;
}

double farthest_of(std::span<const Vec3> positions) {
  const Box box = box_of(positions);
  return std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff());
}

bool near(const Vec3& a, const Vec3& b, double tolerance) {
  return (a - b).cwiseAbs().maxCoeff() <= tolerance;
}

/// Half a step of single precision at the farthest coordinate, twice: texts and sums round, too.
double tolerance_of(const Surface& surface) {
  return std::ldexp(farthest_of(surface.mesh.positions), -22) + 1e-44;
}

std::string position_defect(const Surface& expected, const Surface& found, double tolerance) {
  for (std::size_t i = 0; i < expected.mesh.positions.size(); ++i) {
    if (!near(expected.mesh.positions[i], found.mesh.positions[i], tolerance)) {
      return fmt::format("{}: vertex {} is elsewhere", expected.name, i);
    }
  }
  return {};
}

std::string corner_defect(const Surface& expected, const Surface& found) {
  const double tolerance = tolerance_of(expected);
  for (std::size_t t = 0; t < expected.mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& a = expected.mesh.positions[expected.mesh.triangles[t][k]];
      const Vec3& b = found.mesh.positions[found.mesh.triangles[t][k]];
      if (!near(a, b, tolerance)) {
        return fmt::format("{}: corner {} of triangle {} is elsewhere", expected.name, k, t);
      }
    }
  }
  return {};
}

std::string same_surface_defect(const Surface& expected, const Surface& found, Likeness likeness) {
  const IndexedMesh& a = expected.mesh;
  const IndexedMesh& b = found.mesh;
  if (a.triangles.size() != b.triangles.size()) {
    return fmt::format("{}: {} triangles became {}", expected.name, a.triangles.size(),
                       b.triangles.size());
  }
  if (likeness == Likeness::corners) return corner_defect(expected, found);
  if (a.positions.size() != b.positions.size()) {
    return fmt::format("{}: {} vertices became {}", expected.name, a.positions.size(),
                       b.positions.size());
  }
  if (likeness == Likeness::counts) return {};
  if (likeness == Likeness::floats) return position_defect(expected, found, tolerance_of(expected));
  if (a.triangles != b.triangles) return fmt::format("{}: triangles changed", expected.name);
  return position_defect(expected, found, 0.0);
}

}  // namespace

double extent_of(std::span<const Vec3> positions) {
  const Box box = box_of(positions);
  return (box.high - box.low).norm();
}

bool nearly_collapses(const IndexedMesh& mesh) {
  constexpr double kSteps = 100.0;
  // Of what triangles use: not every format has a place for the rest.
  std::vector<Vec3> positions;
  for (const Triangle& triangle : mesh.triangles) {
    for (const Index v : triangle) positions.push_back(mesh.positions[v]);
  }
  // Below the normal floats a step is no longer relative.
  const double step = std::max(std::ldexp(farthest_of(positions), -23), 1e-44);
  return extent_of(positions) < kSteps * step;
}

std::string surface_defect(const Surface& surface) {
  const std::size_t vertices = surface.mesh.positions.size();
  for (const Vec3& position : surface.mesh.positions) {
    if (!position.allFinite()) return surface.name + ": a position is not finite";
  }
  for (const Triangle& triangle : surface.mesh.triangles) {
    if (*std::max_element(triangle.begin(), triangle.end()) >= vertices) {
      return surface.name + ": a triangle has a vertex that does not exist";
    }
  }
  if (!surface.normals.empty() && surface.normals.size() != vertices) {
    return surface.name + ": there is not one normal per vertex";
  }
  for (const Vec3& normal : surface.normals) {
    if (!normal.allFinite()) return surface.name + ": a normal is not finite";
  }
  for (const PrimitiveVertices& primitive : surface.primitives) {
    if (std::uint64_t{primitive.first} + primitive.count > vertices) {
      return surface.name + ": a primitive has vertices that do not exist";
    }
  }
  if (surface.mesh.triangles.empty()) return surface.name + ": accepted without a triangle";
  return {};
}

std::string extras_defect(const Document& document) {
  const ExtraKinds& kinds = document.facts().extras;
  if (document.surfaces().size() != 1) {
    const bool none = kinds.color_components == 0 && !kinds.texture_coordinates;
    return none ? "" : "extras of several surfaces";
  }
  const std::size_t vertices = document.surfaces().front().mesh.positions.size();
  if (kinds.color_components > 0) {
    const auto colors = document.read_colors();
    if (colors &&
        (colors->components != kinds.color_components ||
         colors->values.size() != vertices * static_cast<std::size_t>(colors->components))) {
      return "colours do not fit the vertices";
    }
    const auto beyond = [](float value) { return !(value >= 0.0F && value <= 1.0F); };
    if (colors && std::any_of(colors->values.begin(), colors->values.end(), beyond)) {
      return "a colour is beyond 0 … 1";
    }
  }
  if (!kinds.texture_coordinates) return {};
  const auto values = document.read_texture_coordinates();
  if (!values) return {};
  if (values->size() != 2 * vertices) return "texture coordinates do not fit the vertices";
  const bool finite =
      std::all_of(values->begin(), values->end(), [](float value) { return std::isfinite(value); });
  return finite ? "" : "a texture coordinate is not finite";
}

std::string lost_extras_defect(const Document& source, const Document& written,
                               const Conversion& conversion) {
  if (conversion.wanted == Format::stl) return {};
  const ExtraKinds& had = source.facts().extras;
  const ExtraKinds& has = written.facts().extras;
  if (had.color_components > 0 && source.read_colors()) {
    const int most = conversion.wanted == Format::obj ? 3 : 4;
    if (has.color_components != std::min(had.color_components, most)) return "colours are lost";
  }
  if (!had.texture_coordinates || !source.read_texture_coordinates()) return {};
  return has.texture_coordinates ? "" : "texture coordinates are lost";
}

std::vector<Surface> with_results(std::span<const Surface> surfaces,
                                  std::span<const SurfaceResult> results) {
  std::vector<Surface> out(surfaces.begin(), surfaces.end());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (results[i].moved) out[i].mesh.positions = results[i].positions;
  }
  return out;
}

std::string same_surfaces_defect(std::span<const Surface> expected, std::span<const Surface> found,
                                 Likeness likeness) {
  if (expected.size() != found.size()) {
    return fmt::format("{} surfaces became {}", expected.size(), found.size());
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (auto defect = same_surface_defect(expected[i], found[i], likeness); !defect.empty()) {
      return defect;
    }
  }
  return {};
}

}  // namespace fairway::test
