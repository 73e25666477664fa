// The colour map, and colours in every format.

#include "proto/formats/vertex_colors.h"

#include <cmath>
#include <cstring>

#include <catch2/catch.hpp>

#include "proto/formats/fresh_mesh.h"
#include "tests/formats/draco_samples.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// CIE lightness L* of a colour, by the definition of sRGB.
double lightness(const Srgb& color) {
  const auto linear = [](std::uint8_t channel) {
    const double c = channel / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const double y =
      0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2]);
  return y > 0.008856 ? 116.0 * std::cbrt(y) - 16.0 : 903.3 * y;
}

/// Vertex v is coloured {10 + v, 20 + v, 200}.
std::vector<SurfaceResult> colored(const Document& document, bool replace = false) {
  std::vector<SurfaceResult> results = unmoved(document);
  for (std::size_t s = 0; s < results.size(); ++s) {
    VertexColors colors;
    colors.replace = replace;
    for (std::size_t v = 0; v < document.surfaces()[s].mesh.positions.size(); ++v) {
      colors.values.push_back(
          {static_cast<std::uint8_t>(10 + v), static_cast<std::uint8_t>(20 + v), 200});
    }
    results[s].colors = colors;
  }
  return results;
}

Bytes written(const Document& document, std::span<const SurfaceResult> results,
              const Conversion& conversion) {
  auto out = convert(document, results, conversion);
  if (!out) FAIL(out.error().message);
  return out->bytes.joined();
}

Json attributes_of(const SampleGlb& sample, std::size_t primitive = 0) {
  return sample.json["meshes"][0]["primitives"][primitive]["attributes"];
}

std::vector<std::uint16_t> shorts_of(const SampleGlb& sample, std::size_t accessor) {
  const Json& def = sample.json["accessors"][accessor];
  REQUIRE(def["componentType"] == 5123);
  REQUIRE(def["type"] == "VEC4");
  REQUIRE(def["normalized"] == true);
  const Json& view = sample.json["bufferViews"][def["bufferView"].get<std::size_t>()];
  std::vector<std::uint16_t> out(def["count"].get<std::size_t>() * 4);
  std::memcpy(out.data(), sample.bin.data() + view["byteOffset"].get<std::size_t>(),
              out.size() * 2);
  return out;
}

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

TEST_CASE("the map is light in the middle, blue below and red above, and clips") {
  const Srgb middle = diverging_colour(0.0);
  CHECK(middle[0] == middle[1]);
  CHECK(middle[1] == middle[2]);
  CHECK(lightness(middle) > 90.0);
  const Srgb low = diverging_colour(-1.0);
  CHECK(low[2] > low[0] + 50);
  const Srgb high = diverging_colour(1.0);
  CHECK(high[0] > high[2] + 50);
  CHECK(diverging_colour(7.0) == high);
  CHECK(diverging_colour(-HUGE_VAL) == low);
}

TEST_CASE("lightness falls in equal steps from the middle, equally on both sides") {
  constexpr int kSteps = 20;
  const double top = lightness(diverging_colour(0.0));
  const double fall = (top - lightness(diverging_colour(1.0))) / kSteps;
  CHECK(fall > 2.5);
  for (int i = 0; i <= kSteps; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double now = lightness(diverging_colour(side * i / kSteps));
      CHECK(now == Approx(top - fall * i).margin(0.6));
    }
  }
}

TEST_CASE("values are coloured between the limits, symmetric about 0") {
  const std::vector<float> values = {-9.0F, -2.0F, -1.0F, 0.0F, 1.0F, 2.0F};
  const std::vector<Srgb> colors = diverging_colours(values, 2.0);
  CHECK(colors == std::vector{diverging_colour(-1), diverging_colour(-1), diverging_colour(-0.5),
                              diverging_colour(0), diverging_colour(0.5), diverging_colour(1)});
}

TEST_CASE("the automatic limit is what 95 % of the magnitudes stay below") {
  std::vector<float> values;
  for (int i = 1; i <= 100; ++i) values.push_back(static_cast<float>(i % 2 == 0 ? i : -i));
  CHECK(automatic_limit(values) == 95.0);
  values.back() = 1e9F;
  CHECK(automatic_limit(values) == 95.0);
  CHECK(automatic_limit({}) == 1.0);
  CHECK(automatic_limit(std::vector<float>(10, 0.0F)) == 1.0);
  CHECK(automatic_limit(std::vector<float>{-3.0F}) == 3.0);
}

TEST_CASE("COLOR_0 is linear, opaque and normalised, and stands in every primitive") {
  const SampleGlb sample = cube_sample();
  const auto document = decoded(sample.glb());
  const SampleGlb out =
      parse_sample(written(*document, colored(*document), {Format::glb, Format::glb}));
  REQUIRE(attributes_of(out).contains("COLOR_0"));
  const auto values = shorts_of(out, attributes_of(out)["COLOR_0"]);
  REQUIRE(values.size() == 32);
  for (std::size_t v = 0; v < 8; ++v) {
    CHECK(values[4 * v + 3] == 65535);
    CHECK(values[4 * v + 2] ==
          Approx(65535.0 * std::pow((200 / 255.0 + 0.055) / 1.055, 2.4)).margin(1.0));
  }
  CHECK(values[0] == Approx(65535.0 * 10 / 255 / 12.92).margin(1.0));
}

TEST_CASE("a primitive that has COLOR_0 keeps it unless it shall be replaced, others get theirs") {
  const auto compression =
      GENERATE(Compression::none, Compression::draco, Compression::meshopt, Compression::keep);
  SampleGlb sample = cube_sample();
  const std::size_t old = sample.add_vec3(cube_corners());
  Json& primitives = sample.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["attributes"]["POSITION"] = sample.add_vec3(cube_corners());
  primitives[1]["attributes"]["COLOR_0"] = old;
  const auto document = decoded(sample.glb());
  Encoding encoding;
  encoding.compression = compression;
  const Conversion conversion{Format::glb, Format::glb, encoding};
  auto results = colored(*document);
  const SampleGlb kept = parse_sample(written(*document, results, conversion));
  CHECK(attributes_of(kept, 0).contains("COLOR_0"));
  CHECK(attributes_of(kept, 1)["COLOR_0"] == old);
  auto notes = kept_color_notes(*document, results, conversion);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].starts_with("1 primitive keeps the colours"));

  results = colored(*document, true);
  CHECK(kept_color_notes(*document, results, conversion).empty());
  const SampleGlb replaced = parse_sample(written(*document, results, conversion));
  CHECK(attributes_of(replaced, 1)["COLOR_0"] != old);
  if (compression == Compression::none) {
    CHECK(shorts_of(replaced, attributes_of(replaced, 1)["COLOR_0"])[2] > 30000);
  }
}

TEST_CASE("colours of Draco primitives are read back, kept or replaced") {
  // Written once with colours, they come as colours of the stream.
  const auto first = decoded(cube_sample().glb());
  Encoding draco;
  draco.compression = Compression::draco;
  const auto compressed =
      decoded(written(*first, colored(*first), {Format::glb, Format::glb, draco}));
  CHECK(compressed->surfaces()[0].primitives[0].has_colors);
  const bool replace = GENERATE(false, true);
  auto results = colored(*compressed, replace);
  for (Srgb& color : results[0].colors->values) color = {0, 255, 0};
  const SampleGlb out = parse_sample(written(*compressed, results, {Format::glb, Format::glb}));
  const auto values = shorts_of(out, attributes_of(out)["COLOR_0"]);
  CHECK((values[1] == 65535) == replace);
  CHECK((values[2] > 30000) == !replace);
}

TEST_CASE("PLY has colours as uchar in sRGB, and keeps or replaces those it has") {
  const auto cube = decoded(cube_sample().glb());
  const Bytes ply = written(*cube, colored(*cube), {Format::glb, Format::ply});
  CHECK(text_of(ply).find("property uchar red\nproperty uchar green\nproperty uchar blue\n") !=
        std::string::npos);
  const auto document = decoded(ply, Format::ply);
  CHECK(document->surfaces()[0].primitives[0].has_colors);
  auto results = colored(*document);
  for (Srgb& color : results[0].colors->values) color = {1, 2, 3};
  CHECK(written(*document, results, {Format::ply, Format::ply}) == ply);
  CHECK(kept_color_notes(*document, results, {Format::ply, Format::ply}).size() == 1);
  // As another format, too.
  CHECK(kept_color_notes(*document, results, {Format::ply, Format::glb}).size() == 1);
  CHECK(kept_color_notes(*document, results, {Format::ply, Format::stl}).empty());
  results[0].colors->replace = true;
  const Bytes replaced = written(*document, results, {Format::ply, Format::ply});
  REQUIRE(replaced.size() == ply.size());
  const std::size_t body = text_of(ply).find("end_header\n") + 11;
  constexpr std::size_t kRow = 12 + 3;
  for (std::size_t v = 0; v < 8; ++v) {
    const std::size_t at = body + v * kRow + 12;
    CHECK(ply[at] == std::byte(10 + v));
    CHECK(replaced[at] == std::byte{1});
    CHECK(replaced[at + 2] == std::byte{3});
  }
}

TEST_CASE("an ascii PLY gets colours as words") {
  const auto document = decoded(
      text_bytes("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
      Format::ply);
  const std::string out =
      text_of(written(*document, colored(*document), {Format::ply, Format::ply}));
  CHECK(out.find("property float z\nproperty uchar red\n") != std::string::npos);
  CHECK(out.find("\n1 0 0 11 21 200\n") != std::string::npos);
}

TEST_CASE("a PLY whose colours are no bytes says so where they shall be replaced") {
  const auto document = decoded(
      text_bytes("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nproperty float red\nelement face 1\n"
                 "property list uchar int vertex_indices\n"
                 "end_header\n0 0 0 1\n1 0 0 1\n0 1 0 1\n3 0 1 2\n"),
      Format::ply);
  const auto refused =
      convert(*document, colored(*document, true), Conversion{Format::ply, Format::ply});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::unsupported_feature);
}

TEST_CASE("a Draco file has colours as COLOR, and they become COLOR_0 of a glTF") {
  const auto bare = decoded(draco_cube(), Format::drc);
  const auto document =
      decoded(written(*bare, colored(*bare), {Format::drc, Format::drc}), Format::drc);
  REQUIRE(document->surfaces()[0].primitives[0].has_colors);
  const bool replace = GENERATE(false, true);
  auto results = colored(*document, replace);
  for (Srgb& color : results[0].colors->values) color = {0, 255, 0};
  const Conversion to_glb{Format::drc, Format::glb};
  CHECK(kept_color_notes(*document, results, to_glb).size() == (replace ? 0 : 1));
  const SampleGlb out = parse_sample(written(*document, results, to_glb));
  const Json def = out.json["accessors"][attributes_of(out)["COLOR_0"].get<std::size_t>()];
  CHECK(def["componentType"] == 5123);
  // In its own format, too.
  const auto again = decoded(written(*document, results, {Format::drc, Format::drc}), Format::drc);
  const SampleGlb glb = parse_sample(written(*again, unmoved(*again), to_glb));
  const std::size_t accessor = attributes_of(glb)["COLOR_0"];
  const Json view =
      glb.json["bufferViews"][glb.json["accessors"][accessor]["bufferView"].get<std::size_t>()];
  const std::size_t offset = view.value("byteOffset", std::size_t{0});
  // Green, of 16 bits.
  CHECK((glb.bin[offset + 3] == std::byte{255}) == replace);
}
