#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

/// Which edges make features: |H_e| > `lambda` (length), in connected groups of at least
/// `min_component` vertices.
struct FeatureRule {
  double lambda = 0.0;
  int min_component = 0;
};

/// 1 per feature vertex of a surface at `positions` (one per surface vertex), eq. (11): the rule of
/// the flows, on a surface that does not move.
std::vector<unsigned char> feature_vertices(const TriangleMesh& mesh,
                                            std::span<const Vec3> positions,
                                            const FeatureRule& rule);

/// Flags of surface vertices per source vertex: 1 where any copy of its place has one, 0 where it
/// is isolated.
std::vector<unsigned char> scatter_flags(const TriangleMesh& mesh,
                                         std::span<const unsigned char> flags);

/// Flags of source vertices per surface vertex: 1 on all copies of the place of each of `sources`,
/// which must be in the source.
std::vector<unsigned char> gather_flags(const TriangleMesh& mesh, std::span<const Index> sources);

}  // namespace fairway
