// How rough a field on a packed surface is.

#include "core/packed_roughness.h"

#include <cmath>
#include <vector>

#include "core/median.h"

namespace fairway {

double roughness_of(const PackedMesh& mesh, std::span<const double> h) {
  std::vector<double> magnitude;
  std::vector<double> deviation;
  for (std::size_t s = 0; s < mesh.slices().size(); ++s) {
    const Slice& slice = mesh.slices()[s];
    if (slice.open) continue;
    for (std::size_t slot = kLanes * s; slot < kLanes * (s + 1); ++slot) {
      if (mesh.vertex_of_slot()[slot] == kNoIndex) continue;
      double sum = 0.0;
      for (Index k = 0; k < slice.valence; ++k) {
        sum += h[mesh.ring()[kLanes * (std::size_t{slice.columns} + k) + slot % kLanes]];
      }
      magnitude.push_back(std::abs(h[slot]));
      deviation.push_back(std::abs(h[slot] - sum / slice.valence));
    }
  }
  const double scale = median(magnitude);
  return scale > 0.0 ? median(deviation) / scale : 0.0;
}

}  // namespace fairway
