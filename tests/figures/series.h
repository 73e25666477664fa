#pragma once

#include <initializer_list>
#include <string>

#include "core/flow_options.h"
#include "core/mesh.h"
#include "core/result.h"
#include "tests/figures/figure.h"

namespace fairway {

/// A figure of one model that fills up panel by panel. Panels are coloured by curvature and
/// measured against the clean mesh.
class Series {
 public:
  /// `noise` in mean edge lengths; the camera looks along `direction`.
  Series(std::string name, IndexedMesh clean, double noise, const Vec3& direction, const Vec3& up);

  const IndexedMesh& clean() const { return clean_; }
  const IndexedMesh& noisy() const { return noisy_; }
  Figure& figure() { return figure_; }

  /// Another view, or the same after the panels have changed their shape.
  void look(const Vec3& direction, const Vec3& up);

  /// Errors of these: those of TriangleMesh::build and denoise.
  Result<void> add(std::string title, IndexedMesh mesh);
  Result<void> add_clean();
  Result<void> add_noisy();
  /// The noisy mesh after a flow.
  Result<void> add_flow(std::string title, const FlowOptions& options);

 private:
  IndexedMesh clean_;
  IndexedMesh noisy_;
  Figure figure_;
};

/// The first failure, if any.
Result<void> all_of(std::initializer_list<Result<void>> done);

}  // namespace fairway
