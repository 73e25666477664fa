// Pictures of few colours.

#include "tests/figures/palette.h"

#include <algorithm>
#include <filesystem>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

/// Half red from dark to light, half a single blue.
Image two_halves() {
  Image image(64, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 64; ++x) {
      const auto level = static_cast<std::uint8_t>(4 * x);
      image.at(x, y) = y < 4 ? Rgb{level, 0, 0} : Rgb{0, 0, 255};
    }
  }
  return image;
}

int farthest(const Image& image, const PaletteImage& few) {
  int out = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Rgb& a = image.at(x, y);
      const Rgb& b = few.colours.at(few.places.at(static_cast<std::size_t>(y * few.width + x)));
      out = std::max({out, std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
    }
  }
  return out;
}

}  // namespace

TEST_CASE("a picture of few colours keeps each of them") {
  Image image(9, 7);
  image.at(0, 0) = {1, 2, 3};
  image.at(8, 6) = {200, 0, 0};
  const PaletteImage few = with_palette(image, 16);
  CHECK(few.colours.size() == 3);
  CHECK(farthest(image, few) == 0);
}

TEST_CASE("a palette has at most as many colours as asked for, and more of them come nearer") {
  const Image image = two_halves();
  int last = 256;
  for (const std::size_t most : {2U, 4U, 9U, 33U}) {
    const PaletteImage few = with_palette(image, most);
    CHECK(few.colours.size() <= most);
    const int error = farthest(image, few);
    CHECK(error < last);
    last = error;
  }
  CHECK(last <= 4);
}

TEST_CASE("a picture of one colour has a palette of one") {
  CHECK(with_palette(Image(3, 3), 256).colours == std::vector<Rgb>{{255, 255, 255}});
}
