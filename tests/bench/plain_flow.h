#pragma once

#include <memory>
#include <span>

#include "core/mesh.h"

namespace fairway::bench {

/// The flows as an average engineer would write them on an OpenMesh halfedge mesh, in double, face
/// normals and edge terms stored in properties: the yardstick of the benchmarks. Explicit, lumped,
/// no guards, recommended conventions.
class PlainFlow {
 public:
  explicit PlainFlow(const IndexedMesh& mesh);
  ~PlainFlow();
  PlainFlow(const PlainFlow&) = delete;
  PlainFlow& operator=(const PlainFlow&) = delete;

  /// One AMC step, eq. (8): λ and s are absolute.
  void amc_step(double lambda, double s);
  /// One PMC step, eq. (11).
  void pmc_step(double lambda, double s);

  Vec3 position(Index vertex) const;
  void set_positions(std::span<const Vec3> positions);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What the topology build is compared with: add_face on a fresh OpenMesh. Returns the faces that
/// found a place.
std::size_t plain_topology(const IndexedMesh& mesh);

}  // namespace fairway::bench
