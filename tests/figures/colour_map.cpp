// A sequential colour map by table.

#include "tests/figures/colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fairway {

Rgb colour_of(double value) {
  // CIE lightness falls from 91 to 12 in equal steps.
  constexpr std::array<std::array<double, 3>, 9> kTable = {{{228, 229, 226},
                                                            {237, 195, 127},
                                                            {235, 157, 71},
                                                            {224, 120, 57},
                                                            {203, 85, 67},
                                                            {171, 57, 82},
                                                            {131, 38, 91},
                                                            {87, 26, 87},
                                                            {44, 18, 68}}};
  const double at = std::clamp(value, 0.0, 1.0) * (kTable.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kTable.size() - 2);
  const double t = at - static_cast<double>(below);
  const auto channel = [&](std::size_t k) {
    return static_cast<std::uint8_t>(
        std::lround((1.0 - t) * kTable[below][k] + t * kTable[below + 1][k]));
  };
  return {channel(0), channel(1), channel(2)};
}

}  // namespace fairway
