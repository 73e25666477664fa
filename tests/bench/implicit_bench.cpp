#include "tests/bench/implicit_bench.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "core/edge_geometry.h"
#include "core/flow_kernels.h"
#include "core/implicit_system.h"
#include "core/packed_mesh.h"
#include "core/thread_team.h"

namespace fairway::bench {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

constexpr double kTolerance = 1e-12;
constexpr int kMostIterations = 1000;

/// Curvature and matrix of one step of size 1 at a feature angle of 30 degrees.
class Step {
 public:
  Step(const TriangleMesh& mesh, double mean_edge, const Execution& execution)
      : packed_(mesh),
        team_(execution.threads),
        kernels_(flow_kernels<double>(execution.isa)),
        system_(packed_, team_, execution.isa),
        x_(packed_.slot_count()),
        h_(x_.size()),
        b_(x_.size()),
        value_(x_.size()),
        strong_(packed_.column_count() + PackedMesh::kPadding) {
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3 p = mesh.positions()[v] / mean_edge;
      x_[packed_.slot_of_vertex()[v]] = {p.x(), p.y(), p.z(), 0.0};
    }
  }

  SolverReport run() {
    const double lambda = lambda_of_feature_angle(30.0, 1.0);
    const StepNumbers<double> numbers = {.time_step = 1.0,
                                         .lambda = lambda,
                                         .transition = 10.0,
                                         .local_step = false,
                                         .prescribed = false};
    const KernelMesh<double> mesh = {packed_.slices().data(), packed_.ring().data(), x_.data(),
                                     1.0};
    kernels_.curvature(mesh, numbers, {h_.data(), nullptr, value_.data(), strong_.data()}, 0,
                       static_cast<Index>(packed_.slices().size()));
    for (std::size_t i = 0; i < b_.size(); ++i) b_[i] = {-h_[i].x, -h_[i].y, -h_[i].z, 0.0};
    system_.assemble(x_, strong_, {},
                     {.time_step = 1.0, .lambda = lambda, .transition = 10.0, .mass = Mass::full});
    return system_.solve(b_, kTolerance, kMostIterations, delta_);
  }

  Matrix matrix() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t slot = 0; slot < x_.size(); ++slot) {
      const Slice& slice = packed_.slices()[slot / kLanes];
      entries.emplace_back(slot, slot, system_.diagonal()[slot]);
      if (packed_.vertex_of_slot()[slot] == kNoIndex) continue;
      for (Index k = 0; k < slice.valence; ++k) {
        const std::size_t at = kLanes * (std::size_t{slice.columns} + k) + slot % kLanes;
        entries.emplace_back(slot, packed_.ring()[at],
                             system_.diagonal()[slot] * system_.coefficients()[at]);
      }
    }
    Matrix out(static_cast<Eigen::Index>(x_.size()), static_cast<Eigen::Index>(x_.size()));
    out.setFromTriplets(entries.begin(), entries.end());
    return out;
  }

  Columns right_side() const {
    Columns out(static_cast<Eigen::Index>(b_.size()), 3);
    for (std::size_t i = 0; i < b_.size(); ++i) {
      out.row(static_cast<Eigen::Index>(i)) << b_[i].x, b_[i].y, b_[i].z;
    }
    return out;
  }

 private:
  PackedMesh packed_;
  ThreadTeam team_;
  const FlowKernels<double>& kernels_;
  ImplicitSystem system_;
  std::vector<Quad<double>> x_, h_, b_, delta_;
  std::vector<double> value_;
  std::vector<std::uint8_t> strong_;
};

}  // namespace

Times implicit_step(const TriangleMesh& mesh, double mean_edge, const Execution& execution,
                    int runs) {
  Step step(mesh, mean_edge, execution);
  const SolverReport ours = step.run();
  Matrix matrix;
  const Columns b = step.right_side();
  Columns x;
  const auto solve = [&] {
    Eigen::BiCGSTAB<Matrix, Eigen::DiagonalPreconditioner<double>> solver;
    solver.setTolerance(kTolerance);
    solver.setMaxIterations(kMostIterations);
    // Its entries are others at every step; what it costs to find them is left out.
    matrix = step.matrix();
    solver.compute(matrix);
    x = solver.solve(b);
  };
  const Times times = in_turn(
      runs, [&] { (void)step.run(); }, solve);
  const double theirs =
      ((b - matrix * x).colwise().norm().array() / b.colwise().norm().array()).maxCoeff();
  // Nobody may win by stopping early.
  if (!ours.converged || ours.residual > 2.0 * std::max(theirs, kTolerance)) {
    fmt::print(stderr, "implicit_step: residual {:.2g}, Eigen {:.2g}\n", ours.residual, theirs);
    return {times.ours, 0.0};
  }
  return times;
}

}  // namespace fairway::bench
