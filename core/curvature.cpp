// Pointwise curvature fields for users, and their way back to the file's vertices.
// Sources: Hildebrandt & Polthier 2004 eq. (5); Meyer et al. 2003 for the area they are divided by.

#include "core/curvature.h"

#include <algorithm>

#include "core/curvature_kernel.h"
#include "core/thread_team.h"

namespace fairway {
namespace {

constexpr std::size_t kGrain = 4096;  // vertices per range

struct alignas(64) Aligned {
  double numbers[kLanes];
};

std::size_t largest_valence(const TriangleMesh& mesh) {
  std::size_t most = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    most = std::max(most, mesh.rings()[v].size());
  }
  return most;
}

template <class T>
std::vector<T> spread(const std::vector<T>& values, const std::vector<Index>& vertex,
                      const T& none) {
  std::vector<T> out;
  out.reserve(vertex.size());
  for (const Index v : vertex) out.push_back(v == kNoIndex ? none : values[v]);
  return out;
}

/// Positions as the kernel gathers them. Any length of the surface's scale would do as the unit: it
/// keeps numbers near 1.
std::vector<Quad<double>> in_units(std::span<const Vec3> positions, double per_length) {
  std::vector<Quad<double>> out(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3 p = positions[v] * per_length;
    out[v] = {p.x(), p.y(), p.z(), 0.0};
  }
  return out;
}

template <class Real>
void compute(const TriangleMesh& surface, std::span<const Vec3> positions,
             const Execution& execution, const CurvatureArrays<Real>& out) {
  const double per_length = 1.0 / surface.mean_edge_length();
  const std::vector<Quad<double>> x = in_units(positions, per_length);
  const RingView rings = {surface.rings().offsets.data(), surface.rings().items.data(),
                          surface.boundary_vertex().data(), x.data()};
  const CurvatureKernel<Real> kernel = curvature_kernel<Real>(execution.isa);
  const std::size_t most = largest_valence(surface);
  ThreadTeam team(execution.threads);
  team.for_ranges(x.size(), kGrain, [&](std::size_t first, std::size_t last) {
    std::vector<Aligned> scratch((most + 1) * kCurvatureScratch);
    kernel(rings, per_length, static_cast<Index>(first), static_cast<Index>(last),
           scratch.data()->numbers, out);
  });
}

}  // namespace

CurvatureFields curvature(const TriangleMesh& surface, std::span<const Vec3> positions,
                          const Execution& execution) {
  CurvatureFields out;
  for (auto* numbers : {&out.k1, &out.k2, &out.mean, &out.gaussian, &out.predominant}) {
    numbers->resize(surface.vertex_count());
  }
  for (auto* vectors : {&out.dir1, &out.dir2}) vectors->resize(surface.vertex_count());
  compute<double>(surface, positions, execution,
                  {out.k1.data(), out.k2.data(), out.mean.data(), out.gaussian.data(),
                   out.predominant.data(), out.dir1.data()->data(), out.dir2.data()->data()});
  return out;
}

CurvatureFloats curvature_floats(const TriangleMesh& surface, std::span<const Vec3> positions,
                                 const Execution& execution) {
  CurvatureFloats out;
  for (auto* numbers : {&out.k1, &out.k2, &out.mean, &out.gaussian, &out.predominant}) {
    numbers->resize(surface.vertex_count());
  }
  for (auto* vectors : {&out.dir1, &out.dir2}) vectors->resize(3 * surface.vertex_count());
  compute<float>(surface, positions, execution,
                 {out.k1.data(), out.k2.data(), out.mean.data(), out.gaussian.data(),
                  out.predominant.data(), out.dir1.data(), out.dir2.data()});
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
