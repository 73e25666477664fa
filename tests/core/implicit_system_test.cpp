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

/// The system of a step on a sphere, some of whose edges count as strong, for a right side of
/// waves.
struct Case {
  TriangleMesh mesh = *TriangleMesh::build(sphere(4, 14.0));
  PackedMesh packed{mesh};
  Vectors positions = Vectors(packed.slot_count());
  Vectors right_side = Vectors(packed.slot_count());
  std::vector<std::uint8_t> strong =
      std::vector<std::uint8_t>(packed.column_count() + PackedMesh::kPadding);

  Case() {
    for (std::size_t i = 0; i < packed.column_count(); i += 5) strong[i] = 0xA5;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3 p = mesh.positions()[v];
      positions[packed.slot_of_vertex()[v]] = {p.x(), p.y(), p.z(), 0.0};
      right_side[packed.slot_of_vertex()[v]] = {std::sin(p.x()), p.y(), std::cos(p.z()), 0.0};
    }
  }

  SolverReport solve(unsigned threads, Isa isa, Vectors& x) const {
    ThreadTeam team(threads);
    ImplicitSystem system(packed, team, isa);
    system.assemble(positions, strong, {},
                    {.time_step = 1.0, .lambda = 0.5, .transition = 10.0, .mass = Mass::full});
    return system.solve(right_side, 1e-12, 1000, x);
  }
};

bool same_bits(const Vectors& a, const Vectors& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].x != b[i].x || a[i].y != b[i].y || a[i].z != b[i].z) return false;
  }
  return a.size() == b.size();
}

}  // namespace

TEST_CASE("a linear system is solved to the same bits by any number of threads") {
  const Case waves;
  Vectors one;
  const SolverReport report = waves.solve(1, best_isa(), one);
  CHECK(report.converged);
  CHECK(report.residual <= 2e-12);
  CHECK(report.iterations > 3);
  for (const unsigned threads : {2U, 3U}) {
    Vectors x;
    waves.solve(threads, best_isa(), x);
    CHECK(same_bits(one, x));
  }
}

TEST_CASE("every instruction set solves the same linear system") {
  const Case waves;
  Vectors plain;
  CHECK(waves.solve(1, Isa::portable, plain).converged);
  for (int isa = 0; isa <= static_cast<int>(best_isa()); ++isa) {
    Vectors x;
    CHECK(waves.solve(1, static_cast<Isa>(isa), x).converged);
    double largest = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      largest = std::fmax(largest, std::fabs(x[i].x - plain[i].x));
      largest = std::fmax(largest, std::fabs(x[i].y - plain[i].y));
      largest = std::fmax(largest, std::fabs(x[i].z - plain[i].z));
    }
    CHECK(largest < 1e-8);
  }
}

TEST_CASE("a linear system with a number that is none is never called solved") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Vectors x;
  for (double Quad<double>::*column : {&Quad<double>::x, &Quad<double>::y, &Quad<double>::z}) {
    Case right;
    right.right_side[right.packed.slot_of_vertex()[7]].*column = kNan;
    const SolverReport of_right = right.solve(1, best_isa(), x);
    CHECK_FALSE(of_right.converged);
    CHECK(std::isnan(of_right.residual));
    Case matrix;
    matrix.positions[matrix.packed.slot_of_vertex()[7]].*column = kNan;
    CHECK_FALSE(matrix.solve(1, best_isa(), x).converged);
    // Not even where there is nothing to solve.
    matrix.right_side.assign(matrix.right_side.size(), Quad<double>{});
    CHECK_FALSE(matrix.solve(1, best_isa(), x).converged);
  }
}

TEST_CASE("nothing to solve is solved by nothing") {
  Case zero;
  zero.right_side.assign(zero.right_side.size(), Quad<double>{});
  Vectors x;
  const SolverReport report = zero.solve(1, best_isa(), x);
  CHECK(report.converged);
  CHECK(report.iterations == 0);
  CHECK(same_bits(x, zero.right_side));
}

}  // namespace fairway
