// Colours and texture coordinates of vertices on their way from any format to any other.

#include "proto/formats/vertex_extras.h"

#include <cmath>
#include <cstring>
#include <sstream>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "core/shapes.h"
#include "proto/formats/bytes.h"
#include "proto/formats/fresh_mesh.h"
#include "proto/formats/obj_extras.h"
#include "tests/formats/draco_samples.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct Written {
  Bytes bytes;
  std::vector<std::string> notes;
};

Written written(const Decoded& document, std::span<const SurfaceResult> results,
                const Conversion& conversion) {
  auto out = convert(*document, results, conversion);
  if (!out) FAIL(out.error().message);
  return {out->bytes.joined(), std::move(out->notes)};
}

Written encoded(const Decoded& document, const Conversion& conversion) {
  return written(document, unmoved(*document), conversion);
}

/// The bytes of the file as another one, which nothing else happened to.
Bytes converted(const Bytes& bytes, Format came, Format wanted, const Encoding& encoding = {}) {
  return encoded(decoded(bytes, came), {came, wanted, encoding}).bytes;
}

/// Rows of a PLY of ours: the bytes of each vertex from the property `first` on.
std::vector<Bytes> rows_from(const Bytes& ply, const std::string& first) {
  const std::string text = text_of(ply);
  std::istringstream header(text.substr(0, text.find("element face")));
  std::size_t count = 0;
  std::size_t row = 0;
  std::size_t begin = std::string::npos;
  for (std::string line; std::getline(header, line);) {
    if (line.starts_with("element vertex ")) count = std::stoul(line.substr(15));
    if (!line.starts_with("property ")) continue;
    if (line.ends_with(" " + first)) begin = row;
    row += line.starts_with("property uchar ") ? 1 : 4;
  }
  REQUIRE(begin != std::string::npos);
  std::vector<Bytes> out;
  const std::size_t body = text.find("end_header\n") + 11;
  for (std::size_t v = 0; v < count; ++v) {
    const auto* at = ply.data() + body + v * row;
    out.emplace_back(at + begin, at + row);
  }
  return out;
}

/// A PLY of 289 vertices in which red, green, blue and alpha run through all bytes.
Bytes all_bytes_ply(bool alpha) {
  Surface surface;
  surface.name = "mesh";
  surface.mesh = sheet(16);
  const std::size_t count = surface.mesh.positions.size();
  REQUIRE(count > 256);
  VertexExtras extras;
  extras.colors.components = alpha ? 4 : 3;
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(extras.colors.components); ++c) {
      extras.colors.values.push_back(static_cast<float>((v + 50 * c) % 256) / 255.0F);
    }
  }
  const auto out = write_fresh_mesh(surface, {}, Format::ply, {}, extras);
  REQUIRE(out);
  return out->bytes.joined();
}

/// A triangle as ascii PLY with more properties of its vertices.
Bytes triangle_ply(const std::string& properties, const std::array<std::string, 3>& rows) {
  return text_bytes(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\n" +
      properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 " +
      rows[0] + "\n1 0 0 " + rows[1] + "\n0 1 0 " + rows[2] + "\n3 0 1 2\n");
}

const std::string kColorProperties =
    "property uchar red\nproperty uchar green\nproperty uchar blue\n";

Json attributes_of(const SampleGlb& sample) {
  return sample.json["meshes"][0]["primitives"][0]["attributes"];
}

/// A cube with an attribute of 8 elements.
template <class T>
SampleGlb cube_with(const std::string& name, const std::vector<T>& values, unsigned type,
                    const std::string& shape, std::size_t stride = 0) {
  SampleGlb sample = cube_sample();
  const std::size_t view = sample.add_view(bytes_of(values), stride);
  const std::size_t accessor = sample.add_accessor(view, type, shape, 8);
  if (type != 5126) sample.json["accessors"][accessor]["normalized"] = true;
  sample.json["meshes"][0]["primitives"][0]["attributes"][name] = accessor;
  return sample;
}

std::vector<float> uv_of(const Decoded& document) {
  const auto values = document->read_texture_coordinates();
  REQUIRE(values);
  return *values;
}

/// The bytes that the colours stand for.
std::vector<int> color_bytes(const Decoded& document) {
  const auto colors = document->read_colors();
  if (!colors) FAIL(colors.error().message);
  REQUIRE_FALSE(colors->empty());
  std::vector<int> out;
  for (const float value : colors->values) out.push_back(color_byte(value));
  return out;
}

std::string notes_of(const Decoded& document, Format came, Format wanted) {
  return fmt::format(
      "{}", fmt::join(conversion_notes(*document, unmoved(*document), came, wanted), "; "));
}

}  // namespace

TEST_CASE("PLY to GLB to PLY keeps every byte of colours and alpha, however it is compressed") {
  const bool alpha = GENERATE(false, true);
  const auto compression =
      GENERATE(Compression::none, Compression::draco, Compression::meshopt, Compression::keep);
  const Format scene = GENERATE(Format::glb, Format::gltf);
  const Bytes ply = all_bytes_ply(alpha);
  const Bytes glb = converted(ply, Format::ply, scene, {compression, {}});
  const Bytes again = converted(glb, scene, Format::ply);
  CHECK(rows_from(again, "red") == rows_from(ply, "red"));
}

TEST_CASE("PLY to Draco to PLY keeps every byte of colours and alpha, by way of a GLB, too") {
  const bool alpha = GENERATE(false, true);
  const Bytes ply = all_bytes_ply(alpha);
  const Bytes drc = converted(ply, Format::ply, Format::drc);
  CHECK(rows_from(converted(drc, Format::drc, Format::ply), "red") == rows_from(ply, "red"));
  const Bytes glb = converted(drc, Format::drc, Format::glb);
  CHECK(rows_from(converted(glb, Format::glb, Format::ply), "red") == rows_from(ply, "red"));
  const Bytes back = converted(glb, Format::glb, Format::drc);
  CHECK(rows_from(converted(back, Format::drc, Format::ply), "red") == rows_from(ply, "red"));
}

TEST_CASE("PLY to OBJ to PLY keeps every byte of colours, and the note tells of alpha") {
  const Bytes ply = all_bytes_ply(false);
  const Bytes obj = converted(ply, Format::ply, Format::obj);
  CHECK(rows_from(converted(obj, Format::obj, Format::ply), "red") == rows_from(ply, "red"));
  CHECK(notes_of(decoded(ply, Format::ply), Format::ply, Format::obj).empty());
  CHECK(notes_of(decoded(all_bytes_ply(true), Format::ply), Format::ply, Format::obj) ==
        "written anew as obj, without alpha of vertices");
}

TEST_CASE("colours of a PLY become linear 16-bit COLOR_0") {
  const auto document =
      decoded(triangle_ply(kColorProperties, {"0 128 255", "10 20 30", "1 2 3"}), Format::ply);
  const SampleGlb out = parse_sample(encoded(document, {Format::ply, Format::glb}).bytes);
  const Json def = out.json["accessors"][attributes_of(out)["COLOR_0"].get<std::size_t>()];
  CHECK(def["componentType"] == 5123);
  CHECK(def["normalized"] == true);
  CHECK(def["type"] == "VEC3");
  const Json view = out.json["bufferViews"][def["bufferView"].get<std::size_t>()];
  CHECK(view["byteStride"] == 8);
  std::array<std::uint16_t, 3> first{};
  std::memcpy(first.data(), out.bin.data() + view["byteOffset"].get<std::size_t>(), 6);
  CHECK(first[0] == 0);
  CHECK(first[1] == std::lround(65535.0 * std::pow((128 / 255.0 + 0.055) / 1.055, 2.4)));
  CHECK(first[2] == 65535);
}

TEST_CASE("colours of a PLY are read as bytes, shorts, floats and doubles") {
  const std::string type = GENERATE("uchar", "ushort", "float", "double");
  const double one = type == "uchar" ? 255.0 : type == "ushort" ? 65535.0 : 1.0;
  std::string properties;
  for (const char* name : {"blue", "red", "green"}) {
    properties += "property " + type + " " + name + "\n";
  }
  const auto row = [&](int blue, int red, int green) {
    return fmt::format("{} {} {}", blue * one / 255, red * one / 255, green * one / 255);
  };
  const auto document = decoded(
      triangle_ply(properties, {row(1, 2, 3), row(0, 255, 128), row(7, 8, 9)}), Format::ply);
  CHECK(color_bytes(document) == std::vector{2, 3, 1, 255, 128, 0, 8, 9, 7});
  CHECK(notes_of(document, Format::ply, Format::glb).empty());
}

TEST_CASE("a binary PLY of either byte order hands on its colours and texture coordinates") {
  const bool big = GENERATE(false, true);
  Bytes ply = text_bytes(fmt::format(
      "ply\nformat binary_{}_endian 1.0\nelement vertex 3\nproperty float t\nproperty list uchar "
      "int marks\nproperty float x\nproperty float y\nproperty float z\nproperty ushort red\n"
      "property ushort green\nproperty ushort blue\nproperty float s\nelement face 1\nproperty "
      "list uchar int vertex_indices\nend_header\n",
      big ? "big" : "little"));
  const auto put = [&](auto value) {
    Bytes bytes;
    append_value(bytes, value);
    if (big) std::reverse(bytes.begin(), bytes.end());
    append(ply, bytes);
  };
  for (int v = 0; v < 3; ++v) {
    put(0.125F * static_cast<float>(v));
    put(static_cast<std::uint8_t>(v));
    for (int i = 0; i < v; ++i) put(std::int32_t{9});
    for (int c = 0; c < 3; ++c) put(v == c + 1 ? 1.5F : 0.0F);
    for (int c = 0; c < 3; ++c) put(static_cast<std::uint16_t>(257 * (10 * v + c)));
    put(0.5F);
  }
  put(std::uint8_t{3});
  for (std::int32_t v = 0; v < 3; ++v) put(v);
  const auto document = decoded(ply, Format::ply);
  CHECK(color_bytes(document) == std::vector{0, 1, 2, 10, 11, 12, 20, 21, 22});
  CHECK(uv_of(document) == std::vector{0.5F, 0.0F, 0.5F, 0.125F, 0.5F, 0.25F});
}

TEST_CASE("what is no colour of all vertices stays behind and is counted") {
  const auto lists =
      decoded(triangle_ply(
                  "property uchar red\nproperty int green\nproperty uchar blue\nproperty float u\n",
                  {"1 2 3 0", "1 2 3 0", "1 2 3 0"}),
              Format::ply);
  CHECK(notes_of(lists, Format::ply, Format::glb) ==
        "written anew as glb, without 4 other properties of vertices");
  const auto alpha = decoded(
      triangle_ply(kColorProperties + "property int alpha\n", {"1 2 3 0", "1 2 3 0", "1 2 3 0"}),
      Format::ply);
  CHECK(alpha->facts().extras.color_components == 3);
  CHECK(notes_of(alpha, Format::ply, Format::glb) ==
        "written anew as glb, without 1 other property of vertices");
}

TEST_CASE("colours beyond 0 … 1 are left out, and the note says so") {
  const auto document =
      decoded(triangle_ply("property float red\nproperty float green\nproperty float blue\n",
                           {"0 0 0", "255 0 0", "nan 0 0"}),
              Format::ply);
  const Written out = encoded(document, {Format::ply, Format::glb});
  REQUIRE(out.notes.size() == 1);
  CHECK(out.notes[0].starts_with("mesh: the colours of its vertices are left out."));
  CHECK_FALSE(attributes_of(parse_sample(out.bytes)).contains("COLOR_0"));
  // Then those that the client asked for have a place.
  auto results = unmoved(*document);
  results[0].colors = VertexColors{{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, false};
  const Written colored = written(document, results, {Format::ply, Format::glb});
  CHECK(attributes_of(parse_sample(colored.bytes)).contains("COLOR_0"));
}

TEST_CASE("texture coordinates of a PLY count v from below, those of a glTF from above") {
  const std::string names = GENERATE("s t", "u v", "texture_u texture_v");
  const std::string first = names.substr(0, names.find(' '));
  const std::string second = names.substr(names.find(' ') + 1);
  const auto document =
      decoded(triangle_ply(fmt::format("property float {}\nproperty double {}\n", first, second),
                           {"0.25 0.125", "-1 2", "0 0"}),
              Format::ply);
  const SampleGlb glb = parse_sample(encoded(document, {Format::ply, Format::glb}).bytes);
  CHECK(floats_of(glb, attributes_of(glb)["TEXCOORD_0"]) ==
        std::vector{0.25F, 0.875F, -1.0F, -1.0F, 0.0F, 1.0F});
  const Bytes ply = converted(glb.glb(), Format::glb, Format::ply);
  CHECK(text_of(ply).find("property float s\nproperty float t\n") != std::string::npos);
  CHECK(uv_of(decoded(ply, Format::ply)) == std::vector{0.25F, 0.125F, -1.0F, 2.0F, 0.0F, 0.0F});
  CHECK(notes_of(document, Format::ply, Format::glb).empty());
}

TEST_CASE("texture coordinates of a Draco file are those of a PLY, rounded as its note states") {
  const auto ply = decoded(
      triangle_ply("property float s\nproperty float t\n", {"0.25 0.125", "0.5 0.75", "0 1"}),
      Format::ply);
  const Written drc = encoded(ply, {Format::ply, Format::drc});
  REQUIRE(drc.notes.size() == 1);
  CHECK(drc.notes[0].find("; TEX_COORD is off by at most ") != std::string::npos);
  const auto close = [](const std::vector<float>& found, const std::vector<float>& expected) {
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      CHECK(found[i] == Approx(expected[i]).margin(2e-4));
    }
  };
  const auto document = decoded(drc.bytes, Format::drc);
  close(uv_of(document), uv_of(ply));
  const SampleGlb glb = parse_sample(encoded(document, {Format::drc, Format::glb}).bytes);
  close(floats_of(glb, attributes_of(glb)["TEXCOORD_0"]), {0.25F, 0.875F, 0.5F, 0.25F, 0, 0});
}

TEST_CASE("a Draco file of another writer hands on colours and texture coordinates") {
  const auto document = decoded(draco_cube({false, false, true, true}), Format::drc);
  const Bytes ply = encoded(document, {Format::drc, Format::ply}).bytes;
  const auto rows = rows_from(ply, "red");
  REQUIRE(rows.size() == 8);
  for (std::size_t v = 0; v < 8; ++v) {
    CHECK(rows[v] == Bytes{std::byte(v), std::byte{100}, std::byte{200}});
  }
  const auto corners = cube_corners();
  const auto uv = uv_of(decoded(ply, Format::ply));
  for (std::size_t v = 0; v < 8; ++v) CHECK(uv[2 * v] == Approx(corners[v][0] / 4 + 0.5F));
  CHECK(notes_of(document, Format::drc, Format::ply).empty());
  CHECK(notes_of(document, Format::drc, Format::stl) ==
        "written anew as stl, without colours of vertices, texture coordinates of vertices");
}

TEST_CASE("COLOR_0 of any component type becomes sRGB bytes of a PLY") {
  const double linear = std::pow((100 / 255.0 + 0.055) / 1.055, 2.4);
  SampleGlb sample;
  int expected = 100;
  SECTION("floats") {
    const std::vector<float> values(24, static_cast<float>(linear));
    sample = cube_with("COLOR_0", values, 5126, "VEC3");
  }
  SECTION("shorts") {
    const std::vector<std::uint16_t> values(
        32, static_cast<std::uint16_t>(std::lround(linear * 65535)));
    sample = cube_with("COLOR_0", values, 5123, "VEC3", 8);
  }
  SECTION("bytes") {
    sample = cube_with("COLOR_0", std::vector<std::uint8_t>(32, 32), 5121, "VEC3", 4);
    expected =
        static_cast<int>(std::lround(255.0 * (1.055 * std::pow(32 / 255.0, 1 / 2.4) - 0.055)));
  }
  const auto document = decoded(sample.glb());
  CHECK(color_bytes(document) == std::vector<int>(24, expected));
  CHECK(rows_from(encoded(document, {Format::glb, Format::ply}).bytes, "red")[7] ==
        Bytes(3, std::byte(expected)));
}

TEST_CASE("TEXCOORD_0 of any component type becomes s and t of a PLY") {
  SampleGlb sample;
  SECTION("floats") {
    sample = cube_with("TEXCOORD_0", std::vector<float>(16, 0.2F), 5126, "VEC2");
  }
  SECTION("shorts") {
    sample = cube_with("TEXCOORD_0", std::vector<std::uint16_t>(16, 13107), 5123, "VEC2");
  }
  SECTION("bytes") {
    sample = cube_with("TEXCOORD_0", std::vector<std::uint8_t>(32, 51), 5121, "VEC2", 4);
  }
  const auto uv = uv_of(decoded(converted(sample.glb(), Format::glb, Format::ply), Format::ply));
  REQUIRE(uv.size() == 16);
  CHECK(uv[14] == Approx(0.2));
  CHECK(uv[15] == Approx(0.8));
}

TEST_CASE("a Draco primitive's colours and texture coordinates become those of a PLY") {
  const auto document = decoded(draco_glb({true, false, true, true}).glb());
  CHECK(document->facts().extras.color_components == 3);
  CHECK(document->facts().extras.texture_coordinates);
  const auto ply = decoded(encoded(document, {Format::glb, Format::ply}).bytes, Format::ply);
  CHECK(color_bytes(ply) == color_bytes(document));
  CHECK(uv_of(ply) == uv_of(document));
}

TEST_CASE("several primitives hand on their colours where all have them") {
  SampleGlb sample = cube_with("COLOR_0", std::vector<float>(24, 0.0F), 5126, "VEC3");
  Json& primitives = sample.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  Json& second = primitives[1]["attributes"];
  second["POSITION"] = sample.add_vec3(cube_corners());
  std::vector<int> expected(24, 0);
  SECTION("one after the other") {
    second["COLOR_0"] = sample.add_vec3(std::vector<std::array<float, 3>>(8, {1, 1, 1}));
    expected.resize(48, 255);
  }
  SECTION("but not where one has none") {
    second.erase("COLOR_0");
    expected.clear();
  }
  SECTION("nor where they have other components") {
    second["COLOR_0"] = sample.add_accessor(sample.add_view(bytes_of(std::vector<float>(32, 1.0F))),
                                            5126, "VEC4", 8);
    expected.clear();
  }
  SECTION("nor where a vertex would have two colours") {
    second["POSITION"] = primitives[0]["attributes"]["POSITION"];
    second["COLOR_0"] = sample.add_vec3(std::vector<std::array<float, 3>>(8, {1, 1, 1}));
    expected.clear();
  }
  const auto document = decoded(sample.glb());
  CHECK((document->facts().extras.color_components > 0) == !expected.empty());
  const bool told =
      notes_of(document, Format::glb, Format::ply).find("other attributes") != std::string::npos;
  CHECK(told == expected.empty());
  if (!expected.empty()) CHECK(color_bytes(document) == expected);
}

TEST_CASE("what is compressed in an unknown way is left out, and the note says so") {
  const Bytes ply = all_bytes_ply(false);
  SampleGlb sample =
      parse_sample(converted(ply, Format::ply, Format::glb, {Compression::meshopt, {}}));
  const std::size_t accessor = attributes_of(sample)["COLOR_0"];
  const std::size_t view = sample.json["accessors"][accessor]["bufferView"];
  sample.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]["filter"] = "COLOR";
  const auto document = decoded(sample.glb());
  const Written out = encoded(document, {Format::glb, Format::ply});
  REQUIRE(out.notes.size() == 1);
  CHECK(out.notes[0].find("the colours of its vertices are left out.") != std::string::npos);
  CHECK(text_of(out.bytes).find("property uchar red") == std::string::npos);
}

TEST_CASE("colours of an OBJ stand behind its positions") {
  const auto document = decoded(text_bytes("v 0 0 0 1 0 0.2\nv 1 0 0 0 1 0 # c\nv 0 1 0 0 \\\n0 1\n"
                                           "f 1 2 3\n"),
                                Format::obj);
  CHECK(color_bytes(document) == std::vector{255, 0, 51, 0, 255, 0, 0, 0, 255});
  const auto rows = rows_from(encoded(document, {Format::obj, Format::ply}).bytes, "red");
  CHECK(rows[0] == Bytes{std::byte{255}, std::byte{0}, std::byte{51}});
  SECTION("at all vertices, or they are counted as lost") {
    const auto some =
        decoded(text_bytes("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 1\nf 1 2 3\n"), Format::obj);
    CHECK(notes_of(some, Format::obj, Format::glb) ==
          "written anew as glb, without 1 colour of a vertex");
  }
}

TEST_CASE("texture coordinates of an OBJ are carried where each vertex has one") {
  const std::string lines =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 9 9 9\nvt 0 0.25\nvt 1\nvt .5 1 7\n";
  const auto document = decoded(text_bytes(lines + "f 1/1 2/2 3/3\nf 2/2 4/1 3/3\n"), Format::obj);
  CHECK(uv_of(document) ==
        std::vector{0.0F, 0.25F, 1.0F, 0.0F, 0.5F, 1.0F, 0.0F, 0.25F, 0.0F, 0.0F});
  const SampleGlb glb = parse_sample(encoded(document, {Format::obj, Format::glb}).bytes);
  CHECK(floats_of(glb, attributes_of(glb)["TEXCOORD_0"])[1] == 0.75F);
  CHECK(notes_of(document, Format::obj, Format::glb).empty());
  for (const char* faces :
       {"f 1/1 2/2 3/3\nf 2/1 4/1 3/3\n", "f 1/1 2/2 3/3\nf 2 4 3\n", "f 1 2 3\nf 2/2 4/1 3/3\n"}) {
    const auto seam = decoded(text_bytes(lines + faces), Format::obj);
    CHECK(notes_of(seam, Format::obj, Format::glb) ==
          "written anew as glb, without 3 texture coordinates");
    const SampleGlb bare = parse_sample(encoded(seam, {Format::obj, Format::glb}).bytes);
    CHECK_FALSE(attributes_of(bare).contains("TEXCOORD_0"));
  }
}

TEST_CASE("a corner that names a vertex far ahead takes no room for it") {
  TextureOfVertex texture;
  texture.add(0, 1, 0);
  texture.add(kNoIndex - 1, 1, 0);
  CHECK(texture.take(1).empty());
}

TEST_CASE("a new OBJ has colours, texture coordinates and normals in its lines") {
  const auto document =
      decoded(triangle_ply("property float nx\nproperty float ny\nproperty float nz\n" +
                               kColorProperties + "property float s\nproperty float t\n",
                           {"0 0 1 255 0 51 0.5 0.25", "0 0 1 0 0 0 1 0", "0 0 1 0 0 0 0 1"}),
              Format::ply);
  CHECK(text_of(encoded(document, {Format::ply, Format::obj}).bytes) ==
        "# fairway\nv 0 0 0 1 0 0.2\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nvt 0.5 0.25\nvt 1 0\nvt 0 1\n"
        "vn 0 0 1\nvn 0 0 1\nvn 0 0 1\nf 1/1/1 2/2/2 3/3/3\n");
}

TEST_CASE("colours that a client asks for stand in the new file unless the old ones stay") {
  const Bytes ply = triangle_ply(kColorProperties, {"1 2 3", "4 5 6", "7 8 9"});
  const auto document = decoded(ply, Format::ply);
  const Format wanted = GENERATE(Format::glb, Format::drc, Format::obj);
  const bool replace = GENERATE(false, true);
  CAPTURE(name_of(wanted), replace);
  auto results = unmoved(*document);
  results[0].colors = VertexColors{std::vector<Srgb>(3, {50, 60, 70}), replace};
  const Conversion conversion{Format::ply, wanted};
  const Written out = written(document, results, conversion);
  CHECK(kept_color_notes(*document, results, conversion).size() == (replace ? 0 : 1));
  CHECK(conversion_notes(*document, results, Format::ply, wanted).empty());
  CHECK(color_bytes(decoded(out.bytes, wanted))[1] == (replace ? 60 : 2));
}

TEST_CASE("an STL has no place for colours and texture coordinates, which is said") {
  const auto document =
      decoded(triangle_ply(kColorProperties + "property float s\nproperty float t\n",
                           {"1 2 3 0 0", "1 2 3 0 0", "1 2 3 0 0"}),
              Format::ply);
  CHECK(notes_of(document, Format::ply, Format::stl) ==
        "written anew as stl, without colours of vertices, texture coordinates of vertices");
  CHECK(encoded(document, {Format::ply, Format::stl}).notes.empty());
}
