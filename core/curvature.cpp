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

}  // namespace

CurvatureFields curvature(const TriangleMesh& surface, std::span<const Vec3> positions,
                          const Execution& execution) {
  const std::size_t n = surface.vertex_count();
  // Any length of the surface's scale would do: it keeps numbers near 1.
  const double per_length = 1.0 / surface.mean_edge_length();
  std::vector<Quad<double>> x(n);
  for (std::size_t v = 0; v < n; ++v) {
    const Vec3 p = positions[v] * per_length;
    x[v] = {p.x(), p.y(), p.z(), 0.0};
  }
  CurvatureFields out;
  for (auto* numbers : {&out.k1, &out.k2, &out.mean, &out.gaussian, &out.predominant}) {
    numbers->resize(n);
  }
  out.dir1.resize(n);
  out.dir2.resize(n);
  const CurvatureArrays arrays = {
      out.k1.data(),          out.k2.data(),           out.mean.data(),        out.gaussian.data(),
      out.predominant.data(), out.dir1.data()->data(), out.dir2.data()->data()};
  const RingView rings = {surface.rings().offsets.data(), surface.rings().items.data(),
                          surface.boundary_vertex().data(), x.data()};
  const CurvatureKernel kernel = curvature_kernel(execution.isa);
  const std::size_t most = largest_valence(surface);
  ThreadTeam team(execution.threads);
  team.for_ranges(n, kGrain, [&](std::size_t first, std::size_t last) {
    std::vector<Aligned> scratch((most + 1) * kCurvatureScratch);
    kernel(rings, per_length, static_cast<Index>(first), static_cast<Index>(last),
           scratch.data()->numbers, arrays);
  });
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
