#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace fairway {

/// The same numbers for a seed on every machine (splitmix64, Box–Muller).
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }
  /// −1 or 1.
  double sign() { return (bits() & 1U) != 0 ? 1.0 : -1.0; }
  /// In (0, 1).
  double unit() { return (static_cast<double>(bits() >> 11U) + 0.5) * 0x1p-53; }
  /// Of the standard normal distribution.
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(unit()));
    return radius * std::cos(2.0 * std::numbers::pi * unit());
  }

 private:
  std::uint64_t state_;
};

}  // namespace fairway
