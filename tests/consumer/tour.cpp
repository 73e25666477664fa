// Denoises a generated mesh by the installed core, and fails where that did not help.

#include <cmath>
#include <cstdio>

#include <fairway/fairway.h>

namespace {

int complain(const fairway::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

}  // namespace

int main() {
  const fairway::IndexedMesh clean = fairway::sphere(4, 2.0);
  const fairway::IndexedMesh noisy = fairway::with_normal_noise(clean, 0.2, 1);
  const auto surface = fairway::TriangleMesh::build(noisy);
  if (!surface) return complain(surface.error());
  const auto flow = fairway::denoise(*surface, fairway::FlowOptions());
  if (!flow) return complain(flow.error());
  fairway::IndexedMesh result = noisy;
  result.positions = surface->scatter_positions(noisy, flow->positions);
  const double before = fairway::mean_normal_error(clean, noisy);
  const double after = fairway::mean_normal_error(clean, result);

  const fairway::CurvatureFields curved = fairway::curvature(*surface, flow->positions);
  double mean = 0.0;
  for (const double one : curved.mean) mean += one / static_cast<double>(curved.mean.size());
  std::printf("normal error %.2f degrees before, %.2f after; mean curvature %.3f\n", before, after,
              mean);
  // A sphere of radius 2 has 1/2 everywhere.
  const bool good = after < 0.5 * before && std::abs(mean - 0.5) < 0.02 &&
                    fairway::halfedge_topology(*surface).pieces.front().genus() == 0;
  return good ? 0 : 1;
}
