#include "core/implicit_system.h"

#include <cmath>
#include <limits>
#include <vector>

#include <catch2/catch.hpp>

#include "core/packed_mesh.h"
#include "core/shapes.h"
#include "core/thread_team.h"

namespace fairway {
namespace {

using Vectors = std::vector<Quad<double>>;

constexpr double Quad<double>::*kColumns[] = {&Quad<double>::x, &Quad<double>::y, &Quad<double>::z};

/// The system of a step on a sphere, some of whose edges count as strong, for a right side of
/// waves.
struct Case {
  TriangleMesh mesh = *TriangleMesh::build(sphere(5, 28.0));
  PackedMesh packed{mesh};
  Vectors positions = Vectors(packed.slot_count());
  Vectors right_side = Vectors(packed.slot_count());
  std::vector<std::uint8_t> strong =
      std::vector<std::uint8_t>(packed.column_count() + PackedMesh::kPadding);
  double time_step = 1.0;
  double tolerance = 1e-12;
  int most_iterations = 1000;

  Case() {
    for (std::size_t i = 0; i < packed.column_count(); i += 5) strong[i] = 0xA5;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3 p = mesh.positions()[v];
      positions[packed.slot_of_vertex()[v]] = {p.x(), p.y(), p.z(), 0.0};
      right_side[packed.slot_of_vertex()[v]] = {std::sin(p.x()), p.y(), std::cos(p.z()), 0.0};
    }
  }

  struct Solution {
    SolverReport report;
    Vectors x;
    double residual;  ///< as found here, in double
  };
  Solution solve(unsigned threads, Isa isa) const {
    ThreadTeam team(threads);
    ImplicitSystem system(packed, team, isa);
    system.assemble(
        positions, strong, {},
        {.time_step = time_step, .lambda = 0.5, .transition = 10.0, .mass = Mass::full});
    Solution out;
    out.report = system.solve(right_side, tolerance, most_iterations, out.x);
    out.residual = residual(system, out.x);
    return out;
  }

 private:
  /// The largest |b − A x| / |b| of the columns.
  double residual(const ImplicitSystem& system, const Vectors& x) const {
    double largest = 0.0;
    for (const auto column : kColumns) {
      double error = 0.0;
      double size = 0.0;
      for (std::size_t slot = 0; slot < x.size(); ++slot) {
        const Slice& slice = packed.slices()[slot / kLanes];
        double row = x[slot].*column;
        for (Index k = 0; k < slice.valence; ++k) {
          const std::size_t at = kLanes * (std::size_t{slice.columns} + k) + slot % kLanes;
          row += system.coefficients()[at] * x[packed.ring()[at]].*column;
        }
        const double b = right_side[slot].*column;
        error += std::pow(b - system.diagonal()[slot] * row, 2);
        size += b * b;
      }
      largest = std::fmax(largest, std::sqrt(error / size));
    }
    return largest;
  }
};

/// Single precision cannot solve it: its numbers are as far apart as these of matrix and mass.
Case stiff_case() {
  Case stiff;
  stiff.time_step = 1e6;
  stiff.tolerance = 1e-8;
  return stiff;
}

bool same_bits(const Vectors& a, const Vectors& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].x != b[i].x || a[i].y != b[i].y || a[i].z != b[i].z) return false;
  }
  return a.size() == b.size();
}

}  // namespace

TEST_CASE("a linear system is solved to the same bits by any number of threads") {
  for (const Case& system : {Case(), stiff_case()}) {
    const Case::Solution one = system.solve(1, best_isa());
    CHECK(one.report.converged);
    CHECK(one.report.iterations > 3);
    for (const unsigned threads : {2U, 3U, 4U}) {
      CHECK(same_bits(one.x, system.solve(threads, best_isa()).x));
    }
  }
}

TEST_CASE("the residual of a solution is that of the system in double, and as reported") {
  const Case::Solution solution = Case().solve(1, best_isa());
  CHECK(solution.residual <= 1.01e-12);
  CHECK(solution.report.residual == Approx(solution.residual).epsilon(0.01));
}

TEST_CASE("every instruction set solves the same linear system") {
  const Case waves;
  const Vectors plain = waves.solve(1, Isa::portable).x;
  for (int isa = 0; isa <= static_cast<int>(best_isa()); ++isa) {
    const Case::Solution solution = waves.solve(1, static_cast<Isa>(isa));
    CHECK(solution.report.converged);
    CHECK(solution.residual <= 1.01e-12);
    double largest = 0.0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      for (const auto column : kColumns) {
        largest = std::fmax(largest, std::fabs(solution.x[i].*column - plain[i].*column));
      }
    }
    CHECK(largest < 1e-9);
  }
}

TEST_CASE("a linear system that single precision cannot solve is solved in double") {
  for (int isa = 0; isa <= static_cast<int>(best_isa()); ++isa) {
    const Case stiff = stiff_case();
    const Case::Solution solution = stiff.solve(1, static_cast<Isa>(isa));
    CHECK(solution.report.converged);
    CHECK(solution.residual <= 10.0 * stiff.tolerance);
  }
}

TEST_CASE("columns of very different size are solved alike") {
  constexpr double kLarge = 0x1p200;
  constexpr double kSmall = 0x1p-200;
  Case scaled;
  const Case::Solution expected = scaled.solve(1, best_isa());
  for (Quad<double>& b : scaled.right_side) b = {kSmall * b.x, b.y, kLarge * b.z, 0.0};
  Case::Solution solution = scaled.solve(1, best_isa());
  CHECK(solution.report.iterations == expected.report.iterations);
  for (Quad<double>& x : solution.x) x = {kLarge * x.x, x.y, kSmall * x.z, 0.0};
  CHECK(same_bits(solution.x, expected.x));
}

TEST_CASE("a column of zeros has the solution zero, and the others theirs") {
  Case holed;
  Vectors expected = holed.solve(1, best_isa()).x;
  for (Quad<double>& b : holed.right_side) b.y = 0.0;
  for (Quad<double>& x : expected) x.y = 0.0;
  CHECK(same_bits(holed.solve(1, best_isa()).x, expected));
}

TEST_CASE("a linear system that needs more iterations than allowed is not called solved") {
  Case hurried;
  hurried.most_iterations = 5;
  const Case::Solution solution = hurried.solve(1, best_isa());
  CHECK_FALSE(solution.report.converged);
  CHECK(solution.report.residual > 1e-11);
  CHECK(solution.report.iterations <= 10);
}

TEST_CASE("a linear system with a number that is none is never called solved") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const auto column : kColumns) {
    Case right;
    right.right_side[right.packed.slot_of_vertex()[7]].*column = kNan;
    const SolverReport of_right = right.solve(1, best_isa()).report;
    CHECK_FALSE(of_right.converged);
    CHECK(std::isnan(of_right.residual));
    Case matrix;
    matrix.positions[matrix.packed.slot_of_vertex()[7]].*column = kNan;
    CHECK_FALSE(matrix.solve(1, best_isa()).report.converged);
    // Not even where there is nothing to solve.
    matrix.right_side.assign(matrix.right_side.size(), Quad<double>{});
    CHECK_FALSE(matrix.solve(1, best_isa()).report.converged);
  }
}

TEST_CASE("nothing to solve is solved by nothing") {
  Case zero;
  zero.right_side.assign(zero.right_side.size(), Quad<double>{});
  const Case::Solution solution = zero.solve(1, best_isa());
  CHECK(solution.report.converged);
  CHECK(solution.report.iterations == 0);
  CHECK(same_bits(solution.x, zero.right_side));
}

}  // namespace fairway
