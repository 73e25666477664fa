#pragma once

#include <string>
#include <vector>

#include "core/flow_options.h"
#include "core/mesh.h"
#include "proto/messages/json.h"

namespace fairway::test {

/// One golden case: a mesh and the numbers of an independent reference implementation.
struct GoldenCase {
  std::string name;
  IndexedMesh mesh;
  Json params;  ///< CASE.params.json
  Json arrays;  ///< "arrays" of CASE.arrays.json

  std::vector<double> numbers(const std::string& array) const;
  std::vector<Vec3> vectors(const std::string& array) const;
  bool has(const std::string& array) const { return arrays.contains(array); }
};

/// Reads tests/core/golden/NAME.*; fails the test where a file is missing.
GoldenCase load_golden(const std::string& name);

/// The golden flow's options: absolute λ and s become the library's λ and τ.
FlowOptions golden_options(const Json& flow_params, double mean_edge);

/// max |a − b| over all components.
double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

/// Largest distance between corresponding points.
double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b);

}  // namespace fairway::test
