#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh.h"

namespace fairway::quality {

/// How a denoised mesh differs from the clean one with the same triangles.
struct Comparison {
  double normal_error = 0.0;   ///< mean angle between face normals, degrees, unweighted
  double feature_error = 0.0;  ///< of the faces at an edge bent by more than 30°; 0 without any
  double mean_distance = 0.0;  ///< of vertices from the clean surface, in bounding box diagonals
  double largest_distance = 0.0;
  double displacement = 0.0;  ///< mean way of a vertex from its clean place, in mean edges
  std::optional<double> volume_change;  ///< percent; of closed meshes only
  std::size_t flipped = 0;              ///< faces turned by more than 90°
  std::size_t degenerate = 0;  ///< with an angle below 0.5°, where the clean mesh has none
};

/// A clean mesh to compare with. The mesh needs welded vertices and no degenerate triangle.
class ReferenceSurface {
 public:
  explicit ReferenceSurface(IndexedMesh mesh);
  ~ReferenceSurface();
  ReferenceSurface(ReferenceSurface&&) noexcept;

  const IndexedMesh& mesh() const { return mesh_; }
  double mean_edge() const { return mean_edge_; }
  Comparison compare(std::span<const Vec3> positions) const;

 private:
  struct Trees;

  double distance(const Vec3& point) const;

  IndexedMesh mesh_;
  double diagonal_ = 0.0;
  double mean_edge_ = 0.0;
  bool closed_ = false;
  std::vector<Vec3> normals_;
  std::vector<unsigned char> beside_feature_;
  std::vector<unsigned char> thin_;
  std::vector<std::vector<Index>> faces_of_;
  std::unique_ptr<Trees> trees_;
};

}  // namespace fairway::quality
