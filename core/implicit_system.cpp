// The linear systems of the semi-implicit flows and of the full mass matrix.
// Sources: Hildebrandt & Polthier 2004, eqs. (7), (12), (13); van der Vorst 1992 (BiCGSTAB);
// Wilkinson 1963 (iterative refinement).

#include "core/implicit_system.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fairway {
namespace {

constexpr std::size_t kGrain = 2048 / kLanes;  // slices per range: sums do not depend on threads

/// How far one run of iterations goes before the true residual is computed anew.
template <class Real>
struct Run;
template <>
struct Run<float> {
  /// Rounding allows 1e-6; three runs instead of two need fewer iterations in all.
  static constexpr double kReduction = 5e-5;
  static constexpr int kMostIterations = 250;
  static constexpr double kAccepted = 1.0;  ///< in tolerances: beyond it, another run
};
template <>
struct Run<double> {
  static constexpr double kReduction = 0.0;
  static constexpr int kMostIterations = std::numeric_limits<int>::max();
  static constexpr double kAccepted = 10.0;
};
constexpr double kLeastProgress = 0.1;  // of a run, in the true residual

/// Three columns side by side; the fourth number is 0.
using Three = Quad<double>;

/// f of each column.
template <class F>
Three by_column(const F& f, const Three& a, const Three& b) {
  return {f(a.x, b.x), f(a.y, b.y), f(a.z, b.z), 0};
}
Three operator+(const Three& a, const Three& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z, 0};
}
Three operator-(const Three& a, const Three& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z, 0};
}
Three operator*(const Three& a, const Three& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z, 0};
}

/// a / b, 0 where b is 0: a column that has converged exactly stands still.
Three safe_ratio(const Three& a, const Three& b) {
  return by_column([](double p, double q) { return q != 0.0 ? p / q : 0.0; }, a, b);
}
/// √(wanted / size), which makes vectors of these squared norms equal; 1 where it is no number.
Three factor_to(const Three& wanted, const Three& size) {
  const auto factor = [](double w, double s) {
    const double f = std::sqrt(w / s);
    return std::isnormal(f) ? f : 1.0;
  };
  return by_column(factor, wanted, size);
}
/// The same where the size is an estimate that may be far too small.
Three growth_to(const Three& wanted, const Three& size) {
  const auto bounded = [](double f, double /*same*/) { return std::min(f, 1e8); };
  const Three factor = factor_to(wanted, size);
  return by_column(bounded, factor, factor);
}
/// 1 where a > b, else 0.
Three greater(const Three& a, const Three& b) {
  return by_column([](double p, double q) { return p > q ? 1.0 : 0.0; }, a, b);
}
/// 0 where not `open`, even of what is infinite.
Three only(const Three& open, const Three& a) {
  return by_column([](double o, double p) { return o != 0.0 ? p : 0.0; }, open, a);
}
bool any(const Three& a) {
  return a.x != 0.0 || a.y != 0.0 || a.z != 0.0;
}
bool is_finite(const Three& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// The squared error a run aims at, from its squared residual at the start: a little less than the
/// tolerance, or as little as the precision allows.
template <class Real>
Three least_wanted(const Three& error, const Three& size, double tolerance) {
  const auto wanted = [&](double e, double s) {
    return std::max(0.8 * tolerance * tolerance * s,
                    Run<Real>::kReduction * Run<Real>::kReduction * e);
  };
  return by_column(wanted, error, size);
}

template <class Real>
SolverVectors<Real> vectors_in(std::array<std::vector<Quad<Real>>, 6>& memory, std::size_t slots) {
  for (std::vector<Quad<Real>>& vector : memory) vector.resize(slots);
  return {memory[0].data(), memory[1].data(), memory[2].data(),
          memory[3].data(), memory[4].data(), memory[5].data()};
}

/// The largest √(error / size) of the columns; NaN if one of them is, infinite for an error where
/// there is nothing to solve.
double relative_error(const Three& error, const Three& size) {
  double largest = 0.0;
  for (const auto [e, s] : {std::array{error.x, size.x}, {error.y, size.y}, {error.z, size.z}}) {
    const double ratio = s == 0.0 && e > 0.0 ? std::numeric_limits<double>::infinity()
                         : s == 0.0          ? e
                                             : e / s;
    if (!(ratio <= largest)) largest = ratio;
    if (std::isnan(ratio)) break;
  }
  return std::sqrt(largest);
}

}  // namespace

ImplicitSystem::ImplicitSystem(const PackedMesh& mesh, ThreadTeam& team, Isa isa)
    : mesh_(mesh), team_(team), kernels_(system_kernels(isa)) {}

void ImplicitSystem::assemble(std::span<const Quad<double>> positions,
                              std::span<const std::uint8_t> strong, std::span<const Index> held,
                              const Numbers& numbers) {
  diagonal_.resize(mesh_.slot_count());
  coefficients_.resize(mesh_.ring().size());
  rounded_diagonal_.resize(diagonal_.size());
  rounded_coefficients_.resize(coefficients_.size());
  const SystemEntries entries = {coefficients_.data(), diagonal_.data(),
                                 rounded_coefficients_.data(), rounded_diagonal_.data()};
  const KernelMesh<double> mesh = {mesh_.slices().data(), mesh_.ring().data(), positions.data(),
                                   1.0};
  const SystemNumbers rows = {numbers.time_step, numbers.lambda, numbers.transition,
                              numbers.mass == Mass::full};
  team_.for_ranges(mesh_.slices().size(), kGrain, [&](std::size_t first, std::size_t last) {
    kernels_.assemble(mesh, strong.data(), rows, static_cast<Index>(first),
                      static_cast<Index>(last), entries);
  });
  for (const Index slot : held) {
    diagonal_[slot] = 1.0;
    rounded_diagonal_[slot] = 1.0F;
    const Slice& slice = mesh_.slices()[slot / kLanes];
    for (Index k = 0; k < slice.valence; ++k) {
      const std::size_t at = kLanes * (std::size_t{slice.columns} + k) + slot % kLanes;
      coefficients_[at] = 0.0;
      rounded_coefficients_[at] = 0.0F;
    }
  }
}

/// The sums of kernel(first slice, last slice) over all slices, by fixed ranges in fixed order.
template <class Kernel>
SolverSums ImplicitSystem::sum_over(const Kernel& kernel) {
  team_.for_ranges(mesh_.slices().size(), kGrain, [&](std::size_t first, std::size_t last) {
    parts_[first / kGrain] = kernel(static_cast<Index>(first), static_cast<Index>(last));
  });
  SolverSums sums{};
  for (const SolverSums& part : parts_) {
    sums = {sums.a + part.a, sums.b + part.b, sums.c + part.c, sums.d + part.d};
  }
  return sums;
}

/// The iteration in one precision.
template <class Real>
struct ImplicitSystem::Solver {
  const SolverKernels<Real>& kernels;
  ScaledMatrix<double> exact;
  ScaledMatrix<Real> matrix;
  SolverVectors<Real> vectors;
};

/// Where a run of iterations stands, per column: ⟨r̃, r⟩, the squared error and how little of it is
/// wanted, in units of the run.
struct ImplicitSystem::State {
  Three rho, error, enough;
};

SolverReport ImplicitSystem::solve(std::span<const Quad<double>> b, double tolerance,
                                   int most_iterations, std::vector<Quad<double>>& x) {
  parts_.resize((mesh_.slices().size() + kGrain - 1) / kGrain);
  const ScaledMatrix<double> exact = {mesh_.slices().data(),
                                      static_cast<Index>(mesh_.slices().size()),
                                      mesh_.ring().data(), coefficients_.data(), diagonal_.data()};
  const ScaledMatrix<float> rounded = {exact.slices, exact.slice_count, exact.ring,
                                       rounded_coefficients_.data(), rounded_diagonal_.data()};
  const Goal goal = {b, tolerance, most_iterations};
  const SolverReport first = solve_in<float>(
      {kernels_.in_single, exact, rounded, vectors_in(single_, mesh_.slot_count())}, goal, x);
  if (first.converged) return first;
  SolverReport report = solve_in<double>(
      {kernels_.in_double, exact, exact, vectors_in(double_, mesh_.slot_count())}, goal, x);
  report.iterations += first.iterations;
  return report;
}

/// Corrects x, from 0 on, by runs of iterations in Real for the true residual, until that is small
/// or stops shrinking.
template <class Real>
SolverReport ImplicitSystem::solve_in(const Solver<Real>& solver, const Goal& goal,
                                      std::vector<Quad<double>>& x) {
  x.assign(mesh_.slot_count(), {});
  const SolverSums sizes = sum_over([&](Index first, Index last) {
    return kernels_.size(diagonal_.data(), goal.b.data(), first, last);
  });
  // Keeps residuals near 1, far from the limits of floats.
  const auto count = static_cast<double>(x.size());
  Three factor = factor_to({count, count, count, 0}, sizes.b);
  SolverReport report;
  report.residual = std::numeric_limits<double>::infinity();
  for (;;) {
    const SolverSums begun = sum_over([&](Index first, Index last) {
      return solver.kernels.restart(solver.exact, goal.b.data(), x.data(), factor, solver.vectors,
                                    first, last);
    });
    const double before = report.residual;
    report.residual = relative_error(begun.a, sizes.a);
    report.converged = report.residual <= 10.0 * goal.tolerance;
    if (report.residual <= Run<Real>::kAccepted * goal.tolerance ||
        !(report.residual <= kLeastProgress * before) ||
        report.iterations >= goal.most_iterations) {
      return report;
    }
    const Three unit = factor * factor;
    State state = {begun.b, unit * begun.a,
                   unit * least_wanted<Real>(begun.a, sizes.a, goal.tolerance)};
    report.iterations +=
        iterate(solver, state,
                std::min(goal.most_iterations - report.iterations, Run<Real>::kMostIterations));
    const Three back = safe_ratio({1, 1, 1, 0}, factor);
    team_.for_ranges(mesh_.slices().size(), kGrain, [&](std::size_t first, std::size_t last) {
      solver.kernels.correct(solver.vectors.x, back, static_cast<Index>(first),
                             static_cast<Index>(last), x.data());
    });
    factor = factor * growth_to(unit * begun.a, state.error);
  }
}

/// BiCGSTAB from what restart() left; returns its iterations. A column that is done stands still:
/// what rounding leaves of its sums would move it anywhere.
template <class Real>
int ImplicitSystem::iterate(const Solver<Real>& solver, State& state, int most_iterations) {
  const SolverKernels<Real>& kernels = solver.kernels;
  const ScaledMatrix<Real>& matrix = solver.matrix;
  const SolverVectors<Real>& vectors = solver.vectors;
  SolverScalars scalars{};
  int iterations = 0;
  // What is not a number ends it too.
  while (iterations < most_iterations && is_finite(state.error)) {
    const Three open = greater(state.error, state.enough);
    if (!any(open)) break;
    const SolverSums along = sum_over(
        [&](Index first, Index last) { return kernels.search(matrix, vectors, first, last); });
    scalars.alpha = only(open, safe_ratio(state.rho, along.a));
    const SolverSums sums = sum_over([&](Index first, Index last) {
      return kernels.stabilise(matrix, vectors, scalars, first, last);
    });
    scalars.omega = only(open, safe_ratio(sums.a, sums.b));
    const Three next_rho = sums.c - scalars.omega * sums.d;
    scalars.beta =
        only(open, safe_ratio(next_rho, state.rho) * safe_ratio(scalars.alpha, scalars.omega));
    state.rho = next_rho;
    state.error = sum_over([&](Index first, Index last) {
                    return kernels.advance(matrix, vectors, scalars, first, last);
                  }).a;
    ++iterations;
  }
  return iterations;
}

}  // namespace fairway
