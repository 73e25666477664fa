// Pointwise curvature fields for users, and their way back to the file's vertices.
// Sources: Hildebrandt & Polthier 2004 eq. (5); Meyer et al. 2003 for the area they are divided by.

#include "core/curvature.h"

#include <cmath>

#include "core/edge_geometry.h"
#include "core/shape_operator.h"
#include "core/surface_geometry.h"

namespace fairway {
namespace {

template <class T>
std::vector<T> spread(const std::vector<T>& values, const std::vector<Index>& vertex,
                      const T& none) {
  std::vector<T> out;
  out.reserve(vertex.size());
  for (const Index v : vertex) out.push_back(v == kNoIndex ? none : values[v]);
  return out;
}

}  // namespace

CurvatureFields curvature(const TriangleMesh& surface, std::span<const Vec3> positions) {
  const double smallest = smallest_area(mean_edge_length(surface, positions));
  const FaceGeometry faces = face_geometry(surface, positions, smallest);
  const EdgeCurvature edges = edge_mean_curvature(surface, positions, faces);
  const std::vector<Vec3> normals = vertex_normals(surface, faces);
  ShapeOperator shape = shape_operator(surface, positions, edges, normals);
  const std::vector<double> area = mixed_area(surface, positions, faces);
  CurvatureFields out;
  out.gaussian = angle_defect(surface, positions, faces);
  out.k1 = std::move(shape.major);
  out.k2 = std::move(shape.minor);
  out.dir1 = std::move(shape.major_direction);
  out.dir2 = std::move(shape.minor_direction);
  out.mean.resize(area.size());
  out.predominant.resize(area.size());
  for (std::size_t v = 0; v < area.size(); ++v) {
    const double per_area = area[v] > 0.0 ? 1.0 / area[v] : 0.0;
    out.k1[v] *= per_area;
    out.k2[v] *= per_area;
    out.gaussian[v] *= surface.boundary_vertex()[v] != 0 ? 0.0 : per_area;
    out.mean[v] = 0.5 * (out.k1[v] + out.k2[v]);
    out.predominant[v] = std::abs(out.k1[v]) >= std::abs(out.k2[v]) ? out.k1[v] : out.k2[v];
  }
  return out;
}

CurvatureFields scatter(const TriangleMesh& surface, const CurvatureFields& fields) {
  const std::vector<Index>& vertex = surface.vertex_of_source();
  const Vec3 zero = Vec3::Zero();
  return {spread(fields.k1, vertex, 0.0),          spread(fields.k2, vertex, 0.0),
          spread(fields.mean, vertex, 0.0),        spread(fields.gaussian, vertex, 0.0),
          spread(fields.predominant, vertex, 0.0), spread(fields.dir1, vertex, zero),
          spread(fields.dir2, vertex, zero)};
}

}  // namespace fairway
