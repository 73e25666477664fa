// The linear systems of the semi-implicit flows and of the full mass matrix.
// Sources: Hildebrandt & Polthier 2004, eqs. (7), (12), (13); van der Vorst 1992 (BiCGSTAB).

#include "core/implicit_system.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fairway {
namespace {

constexpr std::size_t kGrain = 2048 / kLanes;  // slices per range: sums do not depend on threads

/// Three columns side by side; the fourth number is 0.
using Three = Quad<double>;

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
  const auto ratio = [](double p, double q) { return q != 0.0 ? p / q : 0.0; };
  return {ratio(a.x, b.x), ratio(a.y, b.y), ratio(a.z, b.z), 0};
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
  const KernelMesh<double> mesh = {mesh_.slices().data(), mesh_.ring().data(), positions.data(),
                                   1.0};
  const SystemNumbers rows = {numbers.time_step, numbers.lambda, numbers.transition,
                              numbers.mass == Mass::full};
  team_.for_ranges(mesh_.slices().size(), kGrain, [&](std::size_t first, std::size_t last) {
    kernels_.assemble(mesh, strong.data(), rows, static_cast<Index>(first),
                      static_cast<Index>(last), coefficients_.data(), diagonal_.data());
  });
  for (const Index slot : held) {
    diagonal_[slot] = 1.0;
    const Slice& slice = mesh_.slices()[slot / kLanes];
    for (Index k = 0; k < slice.valence; ++k) {
      coefficients_[kLanes * (std::size_t{slice.columns} + k) + slot % kLanes] = 0.0;
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

SolverReport ImplicitSystem::solve(std::span<const Quad<double>> b, double tolerance,
                                   int most_iterations, std::vector<Quad<double>>& x) {
  for (Vectors* vector : {&x, &r_, &shadow_, &p_, &v_, &t_}) vector->resize(mesh_.slot_count());
  parts_.resize((mesh_.slices().size() + kGrain - 1) / kGrain);
  const ScaledMatrix matrix = {mesh_.slices().data(), static_cast<Index>(mesh_.slices().size()),
                               mesh_.ring().data(), coefficients_.data(), diagonal_.data()};
  const SolverVectors vectors = {x.data(),  r_.data(), shadow_.data(),
                                 p_.data(), v_.data(), t_.data()};
  SolverScalars scalars{};
  const SolverSums begun = sum_over([&](Index first, Index last) {
    return kernels_.start(matrix, b.data(), vectors, first, last);
  });
  const Three size = begun.a;
  Three rho = begun.b;
  Three error = size;
  SolverReport report;
  // What is not a number ends it too.
  while (report.iterations < most_iterations && relative_error(error, size) > tolerance) {
    const SolverSums along = sum_over(
        [&](Index first, Index last) { return kernels_.search(matrix, vectors, first, last); });
    scalars.alpha = safe_ratio(rho, along.a);
    const SolverSums sums = sum_over([&](Index first, Index last) {
      return kernels_.stabilise(matrix, vectors, scalars, first, last);
    });
    scalars.omega = safe_ratio(sums.a, sums.b);
    const Three next_rho = sums.c - scalars.omega * sums.d;
    scalars.beta = safe_ratio(next_rho, rho) * safe_ratio(scalars.alpha, scalars.omega);
    rho = next_rho;
    error = sum_over([&](Index first, Index last) {
              return kernels_.advance(matrix, vectors, scalars, first, last);
            }).a;
    ++report.iterations;
  }
  // The recurrence may have drifted: only the true residual counts.
  const SolverSums left = sum_over([&](Index first, Index last) {
    return kernels_.residual(matrix, b.data(), x.data(), first, last);
  });
  report.residual = relative_error(left.a, size);
  report.converged = report.residual <= 10.0 * tolerance;
  return report;
}

}  // namespace fairway
