#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/flow_kernels.h"
#include "core/flow_options.h"
#include "core/implicit_system.h"
#include "core/packed_flow.h"
#include "core/packed_mesh.h"
#include "core/thread_team.h"

namespace fairway {

/// Steps that solve a linear system, eqs. (12), (13), or (7) with the full mass matrix: for the
/// displacement, (M + s K_A) δ = −s (K_A P − f̃ V_A), or M δ = −s (…) for explicit ones. Kept
/// between steps for its memory.
class SystemStep {
 public:
  SystemStep(const PackedMesh& mesh, ThreadTeam& team, Isa isa)
      : mesh_(mesh), system_(mesh, team, isa) {}

  /// On the surface `x`, in L, with the `fields` of each slot: H_A, and for prescribed flows V_A
  /// and f̃; strong edges have the weight w. `held` slots stay. Fills displacement(). A system that
  /// is not solved is tried again with half the step, six times at most. Outcome: solved,
  /// time_step, solver_*.
  PackedFlow::Outcome solve(std::span<const Quad<double>> x, const KernelFields<double>& fields,
                            std::span<const Index> held, const StepNumbers<double>& numbers,
                            const FlowOptions& options);

  std::span<const Quad<double>> displacement() const { return displacement_; }

 private:
  void find_velocity(const KernelFields<double>& fields, std::span<const Index> held,
                     bool prescribed);

  const PackedMesh& mesh_;
  ImplicitSystem system_;
  std::vector<Quad<double>> velocity_;  // H_A − f̃ V_A, 0 at held slots
  std::vector<Quad<double>> right_side_;
  std::vector<Quad<double>> displacement_;
};

}  // namespace fairway
