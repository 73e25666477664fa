// What a run costs, from measured constants.
// Source: processor time (user) and peak resident memory of `fairway denoise FILE OUT` in the
// format of FILE, tori of 130 050 and 999 698 vertices with noise of 0.2 mean edges (`fairway
// sample torus
// --size 255` and `707`), with "steps" 0, 10 and 100; one thread, AVX-512, median of three.
//
//   130 050 vertices   glb    drc    ply    obj    stl      999 698 vertices   glb
//   10 steps, s        0.11   0.30   0.14   0.14   0.12                        1.60
//   100 steps, s       0.44   0.49   0.37   0.50   0.49                        4.86
//   peak, MB           72     97     79     87     81                          654

#include "proto/messages/cost_estimate.h"

#include <algorithm>

namespace fairway {
namespace {

constexpr double kStartSeconds = 0.005;
/// (100 steps − 10 steps) / 90: 28 at 130 thousand vertices, 36 at a million.
constexpr double kNanosecondsPerVertexStep = 35.0;
constexpr double kStartBytes = 12e6;
/// 600 bytes a vertex of a mesh with two triangles for each.
constexpr double kBytesPerVertex = 260.0;
constexpr double kBytesPerTriangle = 170.0;

/// Decode, topology, curvature and encode: 10 steps less ten times the above, and a quarter of that
/// for caches that a million vertices do not fit in.
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
