// The rasteriser: coverage, depth, light, and pictures on disk.

#include "tests/figures/rasteriser.h"

#include <array>
#include <cmath>
#include <filesystem>

#include <catch2/catch.hpp>
#include <png.h>

#include "tests/figures/colour_map.h"
#include "tests/figures/figure.h"

using namespace fairway;

namespace {

constexpr Rgb kWhite = {255, 255, 255};
constexpr Rgb kRed = {200, 0, 0};
constexpr Rgb kBlue = {0, 0, 200};

/// A right triangle in the plane z, (−1, −1), (1, −1), (−1, 1), facing +z.
IndexedMesh triangle_at(double z) {
  return {{Vec3(-1, -1, z), Vec3(1, -1, z), Vec3(-1, 1, z)}, {{0, 1, 2}}};
}

std::array<Rgb, 3> all(Rgb colour) {
  return {colour, colour, colour};
}

}  // namespace

TEST_CASE("a triangle covers the pixels whose centres it holds and no others") {
  // Ten pixels a side show [−1, 1]², y up: row 9 is full, row 0 nearly empty.
  Rasteriser rasteriser(10, 10, 1, Camera());
  rasteriser.draw(triangle_at(0.0), all(kRed), Shading::flat);
  const Image image = rasteriser.image();
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) {
      INFO(x << ", " << y);
      CHECK(image.at(x, y) == (x <= y ? kRed : kWhite));
    }
  }
}

TEST_CASE("the nearer triangle hides the other in whatever order they come") {
  for (const bool near_first : {true, false}) {
    Rasteriser rasteriser(8, 8, 1, Camera());
    // The camera looks along −z: what has the larger z is nearer.
    const auto near = [&] { rasteriser.draw(triangle_at(0.5), all(kBlue), Shading::flat); };
    const auto far = [&] { rasteriser.draw(triangle_at(-0.5), all(kRed), Shading::flat); };
    if (near_first) near();
    far();
    if (!near_first) near();
    CHECK(rasteriser.image().at(1, 6) == kBlue);
  }
}

TEST_CASE("triangles that share an edge leave no gap") {
  Rasteriser rasteriser(16, 16, 3, {.direction = {0.1, 0.2, -1.0}, .half_height = 0.5});
  const IndexedMesh square = {{Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)},
                              {{0, 1, 2}, {0, 2, 3}}};
  rasteriser.draw(square, std::array<Rgb, 4>{kRed, kRed, kRed, kRed}, Shading::flat);
  const Image image = rasteriser.image();
  for (int k = 0; k < 256; ++k) CHECK(image.at(k % 16, k / 16).g == 0);
}

TEST_CASE("what faces the light is lit fully, from either side, and what turns away darkens") {
  const auto red_of = [](const Vec3& direction) {
    Rasteriser rasteriser(8, 8, 1, {.direction = direction, .half_height = 0.2});
    rasteriser.draw(triangle_at(0.0), all(kRed), Shading::smooth);
    return static_cast<int>(rasteriser.image().at(2, 5).r);
  };
  CHECK(red_of({0, 0, -1}) == 200);
  CHECK(red_of({0, 0, 1}) == 200);
  CHECK(red_of({1, 0, -1}) < 170);
  CHECK(red_of({1, 0, -1}) > red_of({3, 0, -1}));
}

TEST_CASE("supersampling gives a half covered pixel the mean colour") {
  Image image(2, 2);
  image.at(0, 0) = {0, 0, 0};
  image.at(1, 1) = {0, 0, 0};
  const Image small = shrunk(image, 2);
  CHECK(small.width() == 1);
  CHECK(static_cast<int>(small.at(0, 0).r) == 128);
}

TEST_CASE("the colour map darkens evenly and clips") {
  // sRGB to CIE lightness.
  const auto linear = [](int byte) {
    const double c = byte / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const auto lightness = [&](double value) {
    const Rgb c = colour_of(value);
    return 116.0 * std::cbrt(0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b)) -
           16.0;
  };
  const double step = (lightness(0.0) - lightness(1.0)) / 8.0;
  for (int k = 0; k < 8; ++k) {
    CHECK(lightness(k / 8.0) - lightness((k + 1) / 8.0) == Approx(step).margin(0.5));
  }
  CHECK(colour_of(-1.0) == colour_of(0.0));
  CHECK(colour_of(7.0) == colour_of(1.0));
}

TEST_CASE("text sets dots inside its box, changes with its letters and is cut off at the rim") {
  const auto dots = [](const char* text, int x) {
    Image image(40, 12);
    draw_text(image, x, 1, text, 1);
    int count = 0;
    for (int k = 0; k < 40 * 12; ++k) count += image.at(k % 40, k / 40) == kWhite ? 0 : 1;
    return count;
  };
  CHECK(dots("I", 0) == 11);
  CHECK(dots("|", 0) == 7);
  CHECK(dots("II", 0) == 22);
  CHECK(dots("I", 39) < 11);
  CHECK(dots("I", -100) == 0);
  CHECK(text_width("abc", 2) == 36);
}

TEST_CASE("a PNG file gives back its pixels, and a directory that is absent is an error") {
  Image image(3, 2);
  image.at(2, 0) = kRed;
  image.at(0, 1) = kBlue;
  const auto path = std::filesystem::temp_directory_path() / "fairway-figures-test.png";
  REQUIRE(write_png(image, path));
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_file(&header, path.c_str()) != 0);
  CHECK(header.width == 3);
  CHECK(header.height == 2);
  header.format = PNG_FORMAT_RGB;
  std::array<Rgb, 6> pixels;
  REQUIRE(png_image_finish_read(&header, nullptr, pixels.data(), 0, nullptr) != 0);
  CHECK(pixels[2] == kRed);
  CHECK(pixels[3] == kBlue);
  CHECK(pixels[0] == kWhite);
  std::filesystem::remove(path);
  const Result<void> refused = write_png(image, "/nonexistent/picture.png");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::io);
}

TEST_CASE("a camera shows all of a mesh and one figure holds every panel at the same size") {
  const IndexedMesh mesh = triangle_at(0.0);
  const Camera camera = camera_for(mesh, {0.3, 0.2, -1.0}, Vec3::UnitY(), 2.0);
  Rasteriser rasteriser(60, 30, 1, camera);
  rasteriser.draw(mesh, all(kRed), Shading::flat);
  const Image image = rasteriser.image();
  int covered = 0;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 60; ++x) {
      const bool rim = x == 0 || y == 0 || x == 59 || y == 29;
      if (image.at(x, y) == kWhite) continue;
      CHECK_FALSE(rim);
      ++covered;
    }
  }
  CHECK(covered > 200);
}

TEST_CASE("a figure's Markdown has one row a panel, whatever its notes contain") {
  Figure figure;
  figure.name = "name";
  figure.caption = "Caption.";
  figure.panels.resize(2);
  figure.panels[0].title = "noisy";
  figure.panels[0].note = "ridge |k| 3";
  figure.panels[1].scale = {0.5, "|k| L"};
  CHECK(markdown(figure) ==
        "## name\n![name](name.png)\n\nCaption.\n\n| panel | measured | colours |\n|---|---|---|\n"
        "| (a) noisy | ridge \\|k\\| 3 |  from 0 to 1 |\n"
        "| (b)  |  | \\|k\\| L from 0 to 0.5 |\n\n");
}
