// What a run costs, from measured constants.
// Source: processor time (user) and peak resident memory of `fairway denoise FILE OUT` in the
// format of FILE, tori with noise of 0.2 mean edges (`fairway sample torus --size 132`, `255` and
// `707`), whose path goes to its end; one thread. A path that ends sooner takes half of it.
//
//               34 848 glb    130 050 glb    drc    ply    obj    stl    999 698 glb
//   default, s        1.12           6.00   5.15   5.33   6.15   5.96          47.82
//   peak, MB            81            280    283    279    301    288           2090
//   10 steps of a flow, s            0.11   0.21   0.13   0.13   0.11           1.05

#include "proto/messages/cost_estimate.h"

#include <algorithm>

namespace fairway {
namespace {

constexpr double kStartSeconds = 0.005;
/// Of the path's 24 steps: 1.3 µs at 35 thousand vertices, 1.9 at a million.
constexpr double kNanosecondsPerVertexStep = 1800.0;
constexpr double kStartBytes = 12e6;
/// 2100 bytes a vertex of a mesh with two triangles for each.
constexpr double kBytesPerVertex = 900.0;
constexpr double kBytesPerTriangle = 600.0;

/// Decode, topology, curvature and encode: ten steps of a flow less ten times what they take, and a
/// quarter of that for caches that a million vertices do not fit in.
double nanoseconds_per_vertex(Format format) {
  switch (format) {
    case Format::drc:
      return 2400.0;
    case Format::ply:
    case Format::obj:
      return 1000.0;
    case Format::glb:
    case Format::gltf:
    case Format::stl:
      break;
  }
  return 900.0;
}

}  // namespace

CostEstimate estimate_cost(const CostSubject& subject) {
  const auto vertices = static_cast<double>(subject.vertices);
  const auto triangles = static_cast<double>(subject.triangles);
  CostEstimate out;
  out.steps = subject.steps;
  out.seconds = kStartSeconds + 1e-9 * (nanoseconds_per_vertex(subject.format) *
                                            std::max(vertices, triangles / 2.0) +
                                        kNanosecondsPerVertexStep * subject.vertex_steps);
  out.memory_bytes =
      subject.bytes + static_cast<std::uint64_t>(kStartBytes + kBytesPerVertex * vertices +
                                                 kBytesPerTriangle * triangles);
  return out;
}

}  // namespace fairway
