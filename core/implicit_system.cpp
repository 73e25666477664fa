// The linear systems of the semi-implicit flows and of the full mass matrix.
// Sources: Hildebrandt & Polthier 2004, eqs. (7), (12), (13); van der Vorst 1992 (BiCGSTAB).

#include "core/implicit_system.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace fairway {
namespace {

constexpr std::size_t kGrain = 2048;  // slots per range: sums do not depend on the threads

/// Three columns side by side; the fourth lane is carried along as zero.
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
Three operator*(double s, const Three& a) {
  return {s * a.x, s * a.y, s * a.z, 0};
}

/// a / b, 0 where b is 0: a column that has converged exactly stands still.
Three safe_ratio(const Three& a, const Three& b) {
  const auto ratio = [](double p, double q) { return q != 0.0 ? p / q : 0.0; };
  return {ratio(a.x, b.x), ratio(a.y, b.y), ratio(a.z, b.z), 0};
}

double largest(const Three& a) {
  return std::max({a.x, a.y, a.z});
}

double dot3(const Three& a, const Three& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Three cross(const Three& a, const Three& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x, 0};
}

/// One triangle (p, a, b) of a ring.
struct Corner {
  double area = 0.0;  // 0: absent
  double cot_p = 0.0, cot_a = 0.0, cot_b = 0.0;
  Three normal{};

  Corner(const Three& a, const Three& b) {
    const Three n = cross(a, b);
    const double twice = std::sqrt(dot3(n, n));
    if (!(twice > 2e-12)) return;
    area = 0.5 * twice;
    cot_p = dot3(a, b) / twice;
    cot_a = (dot3(a, a) - dot3(a, b)) / twice;
    cot_b = (dot3(b, b) - dot3(a, b)) / twice;
    normal = (1.0 / twice) * n;
  }
  Corner() = default;
};

/// Sums term(slot) over all slots, by fixed ranges in fixed order.

template <class Term>
Three sum_over(ThreadTeam& team, std::size_t slots, const Term& term) {
  std::vector<Three> parts((slots + kGrain - 1) / kGrain, Three{});
  team.for_ranges(slots, kGrain, [&](std::size_t first, std::size_t last) {
    Three sum{};
    for (std::size_t i = first; i < last; ++i) sum = sum + term(i);
    parts[first / kGrain] = sum;
  });
  Three sum{};
  for (const Three& part : parts) sum = sum + part;
  return sum;
}

}  // namespace

void ImplicitSystem::assemble_slot(std::span<const Quad<double>> x,
                                   std::span<const std::uint8_t> strong, const Numbers& numbers,
                                   Index slot) {
  const Slice& slice = mesh_.slices()[slot / kLanes];
  const Index lane = slot % kLanes;
  const std::size_t row = kLanes * std::size_t{slice.columns} + lane;
  const Index d = slice.valence;
  const auto edge_to = [&](Index k) {
    return x[mesh_.ring()[row + kLanes * std::size_t{k}]] - x[slot];
  };
  const auto entry = [&](Index k) -> double& {
    return coefficients_[row + kLanes * std::size_t{k}];
  };
  for (Index k = 0; k < d; ++k) entry(k) = 0.0;
  double diagonal = 0.0;
  const bool full = numbers.mass == Mass::full;
  const auto add_mass = [&](const Corner& face, Index k, Index next) {
    diagonal += face.area / (full ? 6.0 : 3.0);
    if (!full) return;
    entry(k) += face.area / 12.0;
    entry(next) += face.area / 12.0;
  };
  const auto add_edge = [&](const Corner& left, const Corner& right, Index before, Index k,
                            Index next) {
    if (left.area == 0.0 || right.area == 0.0) return;
    double weight = 0.5 * numbers.time_step;
    if ((strong[slice.columns + k] >> lane & 1U) != 0) {
      const Three term = cross(edge_to(k), left.normal - right.normal);
      const double excess = std::sqrt(dot3(term, term)) / numbers.lambda - 1.0;
      weight /= numbers.transition * excess * excess + 1.0;
    }
    // At q_k: angle a of the left face, angle b of the right one.
    diagonal += weight * (left.cot_a + right.cot_b);
    entry(k) += weight * (left.cot_p + right.cot_p);
    entry(next) -= weight * (left.cot_p + left.cot_a);
    entry(before) -= weight * (right.cot_p + right.cot_b);
  };
  const Corner first(edge_to(0), edge_to(1));
  add_mass(first, 0, 1);
  Corner before = first;
  for (Index k = 1; k + 1 < d; ++k) {
    const Corner face(edge_to(k), edge_to(k + 1));
    add_mass(face, k, k + 1);
    add_edge(face, before, k - 1, k, k + 1);
    before = face;
  }
  if (!slice.open) {
    const Corner last(edge_to(d - 1), edge_to(0));
    add_mass(last, d - 1, 0);
    add_edge(last, before, d - 2, d - 1, 0);
    add_edge(first, last, d - 1, 0, 1);
  }
  diagonal_[slot] = diagonal > 0.0 ? diagonal : 1.0;
}

void ImplicitSystem::assemble(std::span<const Quad<double>> positions,
                              std::span<const std::uint8_t> strong, std::span<const Index> held,
                              const Numbers& numbers) {
  diagonal_.resize(mesh_.slot_count());
  coefficients_.resize(mesh_.ring().size());
  team_.for_ranges(mesh_.slot_count(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t slot = first; slot < last; ++slot) {
      assemble_slot(positions, strong, numbers, static_cast<Index>(slot));
    }
  });
  for (const Index slot : held) {
    diagonal_[slot] = 1.0;
    const Slice& slice = mesh_.slices()[slot / kLanes];
    for (Index k = 0; k < slice.valence; ++k) {
      coefficients_[kLanes * (std::size_t{slice.columns} + k) + slot % kLanes] = 0.0;
    }
  }
}

void ImplicitSystem::multiply(const Vectors& x, Vectors& out) const {
  team_.for_ranges(mesh_.slices().size(), kGrain / kLanes,
                   [&](std::size_t first, std::size_t last) {
                     for (std::size_t s = first; s < last; ++s) {
                       const Slice& slice = mesh_.slices()[s];
                       for (std::size_t lane = 0; lane < kLanes; ++lane) {
                         const std::size_t slot = kLanes * s + lane;
                         Three sum = diagonal_[slot] * x[slot];
                         std::size_t at = kLanes * std::size_t{slice.columns} + lane;
                         for (Index k = 0; k < slice.valence; ++k, at += kLanes) {
                           sum = sum + coefficients_[at] * x[mesh_.ring()[at]];
                         }
                         out[slot] = sum;
                       }
                     }
                   });
}

double ImplicitSystem::true_residual(std::span<const Quad<double>> b, const Vectors& x) {
  multiply(x, t_);
  const Three error = sum_over(team_, x.size(), [&](std::size_t i) {
    const Three e = b[i] - t_[i];
    return e * e;
  });
  const Three size = sum_over(team_, x.size(), [&](std::size_t i) { return b[i] * b[i]; });
  return std::sqrt(largest(safe_ratio(error, size)));
}

SolverReport ImplicitSystem::solve(std::span<const Quad<double>> b, double tolerance,
                                   int most_iterations, std::vector<Quad<double>>& x) {
  const std::size_t n = mesh_.slot_count();
  for (Vectors* work : {&r_, &shadow_, &p_, &v_, &s_, &t_, &y_, &z_}) work->resize(n);
  x.assign(n, Three{});
  std::fill(p_.begin(), p_.end(), Three{});
  std::fill(v_.begin(), v_.end(), Three{});
  std::copy(b.begin(), b.end(), r_.begin());
  shadow_ = r_;
  const auto each = [&](const auto& body) {
    team_.for_ranges(n, kGrain, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) body(i);
    });
  };
  const Three size = sum_over(team_, n, [&](std::size_t i) { return b[i] * b[i]; });
  Three rho{1, 1, 1, 0};
  Three alpha{1, 1, 1, 0};
  Three omega{1, 1, 1, 0};
  Three rho_next = size;
  SolverReport report;
  for (; report.iterations < most_iterations; ++report.iterations) {
    const Three beta = safe_ratio(rho_next, rho) * safe_ratio(alpha, omega);
    rho = rho_next;
    each([&](std::size_t i) {
      p_[i] = r_[i] + beta * (p_[i] - omega * v_[i]);
      y_[i] = (1.0 / diagonal_[i]) * p_[i];
    });
    multiply(y_, v_);
    alpha = safe_ratio(rho, sum_over(team_, n, [&](std::size_t i) { return shadow_[i] * v_[i]; }));
    each([&](std::size_t i) {
      s_[i] = r_[i] - alpha * v_[i];
      z_[i] = (1.0 / diagonal_[i]) * s_[i];
    });
    multiply(z_, t_);
    const Three ts = sum_over(team_, n, [&](std::size_t i) { return t_[i] * s_[i]; });
    const Three tt = sum_over(team_, n, [&](std::size_t i) { return t_[i] * t_[i]; });
    omega = safe_ratio(ts, tt);
    each([&](std::size_t i) {
      x[i] = x[i] + alpha * y_[i] + omega * z_[i];
      r_[i] = s_[i] - omega * t_[i];
    });
    const Three error = sum_over(team_, n, [&](std::size_t i) { return r_[i] * r_[i]; });
    rho_next = sum_over(team_, n, [&](std::size_t i) { return shadow_[i] * r_[i]; });
    if (largest(safe_ratio(error, size)) <= tolerance * tolerance) break;
    if (!std::isfinite(largest(error))) break;
  }
  // The recurrence may have drifted: only the true residual counts.
  report.residual = true_residual(b, x);
  report.converged = report.residual <= 10.0 * tolerance;
  return report;
}

}  // namespace fairway
