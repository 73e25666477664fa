#include <cmath>
#include <limits>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "proto/formats/bytes.h"
#include "proto/formats/document.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

std::string text_of(const Bytes& bytes) {
  return std::string(as_text(bytes));
}

ErrorCode refusal(const std::string& ply) {
  const Bytes bytes = text_bytes(ply);
  const auto document = decode(bytes, Format::ply);
  REQUIRE_FALSE(document);
  CHECK(document.error().message.size() > 20);
  return document.error().code;
}

const std::string kHeader =
    "ply\nformat ascii 1.0\ncomment made by hand\nobj_info 7\nelement material 1\n"
    "property uchar shine\nelement vertex 4\nproperty uchar red\nproperty double x\n"
    "property float y\nproperty float z\nproperty float nx\nproperty float ny\n"
    "property float nz\nproperty list uchar int marks\ncomment between\nelement face 2\n"
    "property uchar part\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kBody =
    "9\n10 0.00 0 0  0 0 1 0\n20 1 0 0  0 0 1 2 5 6\n\n30 1 1 0  0 0 1 0\n40 0 1 1e0  0 0 1 1 nan\n"
    "1 4 0 1 2 3\n2 3 0 2 1 \n";

/// A tetrahedron as a binary file, `big` with the other byte order.
Bytes binary_tetrahedron(bool big) {
  Bytes out = text_bytes(fmt::format(
      "ply\nformat binary_{}_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty ushort id\nelement face 4\nproperty list uchar int "
      "vertex_index\nproperty float q\nend_header\n",
      big ? "big" : "little"));
  const auto put = [&](auto value) {
    Bytes bytes;
    append_value(bytes, value);
    if (big) std::reverse(bytes.begin(), bytes.end());
    append(out, bytes);
  };
  for (int v = 0; v < 4; ++v) {
    for (int c = 0; c < 3; ++c) put(v == c + 1 ? 1.5F : 0.0F);
    put(static_cast<std::uint16_t>(1000 + v));
  }
  constexpr std::int32_t kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (const auto& face : kFaces) {
    put(std::uint8_t{3});
    for (const std::int32_t corner : face) put(corner);
    put(0.25F);
  }
  return out;
}

}  // namespace

TEST_CASE("an ascii PLY comes back with only its positions and normals replaced") {
  const auto document = decoded(text_bytes(kHeader + kBody), Format::ply);
  const Surface& surface = document->surfaces().at(0);
  REQUIRE(surface.mesh.positions.size() == 4);
  CHECK(surface.mesh.positions[3] == Vec3(0, 1, 1));
  CHECK(surface.mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 2, 1}});
  CHECK(surface.normals.size() == 4);
  CHECK(text_of(*document->encode(unmoved(*document), Format::ply)) == kHeader + kBody);

  auto results = shifted(*document, Vec3(0.1, 0, 0));
  for (Vec3& normal : results[0].normals) normal = Vec3(1, 0, 0);
  CHECK(text_of(*document->encode(results, Format::ply)) ==
        kHeader +
            "9\n10 0.1 0 0  1 0 0 0\n20 1.1 0 0  1 0 0 2 5 6\n\n30 1.1 1 0  1 0 0 0\n"
            "40 0.1 1 1e0  1 0 0 1 nan\n1 4 0 1 2 3\n2 3 0 2 1 \n");
}

TEST_CASE("attributes become float properties behind those of the vertices") {
  const auto document = decoded(text_bytes(kHeader + kBody), Format::ply);
  auto results = unmoved(*document);
  add_ramp(*document, "_CURVATURE_K1", 1, results);
  add_ramp(*document, "_CURVATURE_DIR1", 3, results);
  add_ramp(*document, "_FEATURE", 1, results);
  const std::string out = text_of(*document->encode(results, Format::ply));
  CHECK(out.find("property list uchar int marks\nproperty float curvature_k1\nproperty float "
                 "curvature_dir1_x\nproperty float curvature_dir1_y\nproperty float "
                 "curvature_dir1_z\nproperty float feature\ncomment between\n") !=
        std::string::npos);
  CHECK(out.find("\n20 1 0 0  0 0 1 2 5 6 1 3 4 5 1\n") != std::string::npos);

  SECTION("and are replaced where the file has them already") {
    const auto again = decoded(text_bytes(out), Format::ply);
    auto zeros = unmoved(*again);
    add_ramp(*again, "_CURVATURE_K1", 1, zeros);
    zeros[0].attributes[0].values.assign(4, 0.0F);
    const std::string twice = text_of(*again->encode(zeros, Format::ply));
    CHECK(twice.find("\n20 1 0 0  0 0 1 2 5 6 0 3 4 5 1\n") != std::string::npos);
    CHECK(twice.find("curvature_k1") == twice.rfind("curvature_k1"));
  }
  SECTION("but never a property of another type") {
    std::string taken = kHeader + kBody;
    taken.replace(taken.find("uchar red"), 9, "uchar feature");
    const auto other = decoded(text_bytes(taken), Format::ply);
    auto features = unmoved(*other);
    add_ramp(*other, "_FEATURE", 1, features);
    CHECK(other->encode(features, Format::ply).error().code == ErrorCode::unsupported_feature);
  }
}

TEST_CASE("a binary PLY of either byte order comes back byte for byte but for what moved") {
  const bool big = GENERATE(false, true);
  const Bytes before = binary_tetrahedron(big);
  const auto document = decoded(before, Format::ply);
  CHECK(document->surfaces()[0].mesh.positions[3] == Vec3(0, 0, 1.5));
  CHECK(document->surfaces()[0].mesh.triangles.size() == 4);
  CHECK(*document->encode(unmoved(*document), Format::ply) == before);
  CHECK(*document->encode(shifted(*document, Vec3::Zero()), Format::ply) == before);
  auto results = shifted(*document, Vec3(0, 0.25, 0));
  add_ramp(*document, "_CURVATURE_MEAN", 1, results);
  const auto out = document->encode(results, Format::ply);
  REQUIRE(out);
  CHECK(out->size() == before.size() + 16 + std::string("property float curvature_mean\n").size());
  const auto again = decoded(*out, Format::ply);
  for (std::size_t v = 0; v < 4; ++v) {
    CHECK(again->surfaces()[0].mesh.positions[v] == results[0].positions[v]);
  }
  CHECK(again->surfaces()[0].mesh.triangles == document->surfaces()[0].mesh.triangles);
  // The faces stand at the end, as they were.
  CHECK(std::equal(out->end() - 68, out->end(), before.end() - 68));
}

TEST_CASE("strips of a PLY become triangles and are written as they came") {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
      "z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 1\n9 0 1 2 3 -1 2 3 4 -1\n";
  const auto document = decoded(text_bytes(ply), Format::ply);
  CHECK(document->surfaces()[0].mesh.triangles ==
        std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}});
  const std::string out =
      text_of(*document->encode(shifted(*document, Vec3(1, 0, 0)), Format::ply));
  CHECK(out.find("\n9 0 1 2 3 -1 2 3 4 -1\n") != std::string::npos);
}

TEST_CASE("every truncation of a binary PLY is refused as malformed or broken") {
  const Bytes whole = binary_tetrahedron(false);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CAPTURE(size);
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const auto document = decode(cut, Format::ply);
    REQUIRE_FALSE(document);
    // A version that is cut is another version.
    const ErrorCode code = document.error().code;
    CHECK((code == ErrorCode::malformed_input || code == ErrorCode::invalid_mesh ||
           (code == ErrorCode::unsupported_format && size < 40)));
  }
}

TEST_CASE("a PLY whose header ends its lines with CR may have data that begins with LF") {
  Bytes bytes = binary_tetrahedron(false);
  const std::size_t header = as_text(bytes).find("end_header\n") + 11;
  for (std::size_t i = 0; i < header; ++i) {
    if (bytes[i] == std::byte{'\n'}) bytes[i] = std::byte{'\r'};
  }
  bytes[header] = std::byte{'\n'};
  const auto document = decoded(bytes, Format::ply);
  CHECK(document->surfaces()[0].mesh.positions[3] == Vec3(0, 0, 1.5));
}

TEST_CASE("claims of a PLY are checked before they are believed") {
  const auto with = [](const std::string& old, const std::string& now) {
    std::string ply = kHeader + kBody;
    const std::size_t at = ply.find(old);
    REQUIRE(at != std::string::npos);
    return refusal(ply.replace(at, old.size(), now));
  };
  CHECK(with("element vertex 4", "element vertex 4000000000") == ErrorCode::invalid_mesh);
  CHECK(with("element vertex 4", "element vertex 18446744073709551617") ==
        ErrorCode::malformed_input);
  CHECK(with("element vertex 4", "element vertex -1") == ErrorCode::invalid_mesh);
  CHECK(with("element vertex 4", "element vertex 0") == ErrorCode::no_triangles);
  CHECK(with("element face 2", "element face 3") == ErrorCode::malformed_input);
  CHECK(with("element face 2", "element face 0") == ErrorCode::no_triangles);
  CHECK(with("property uchar shine\n", "") == ErrorCode::invalid_mesh);
  CHECK(with("ascii 1.0", "ascii 2.0") == ErrorCode::unsupported_format);
  CHECK(with("property double x", "property int x") == ErrorCode::unsupported_feature);
  CHECK(with("property double x", "property float y") == ErrorCode::invalid_mesh);
  CHECK(with("list uchar int vertex", "list float int vertex") == ErrorCode::malformed_input);
  CHECK(with("list uchar int vertex", "list uchar float vertex") == ErrorCode::invalid_mesh);
  CHECK(with("end_header", "end") == ErrorCode::malformed_input);
  CHECK(with("1 4 0 1 2 3", "1 4 0 1 2 4") == ErrorCode::invalid_mesh);
  CHECK(with("1 4 0 1 2 3", "1 4 0 1 2 -1") == ErrorCode::invalid_mesh);
  CHECK(with("1 4 0 1 2 3", "1 2 0 1") == ErrorCode::invalid_mesh);
  CHECK(with("1 4 0 1 2 3", "1 4 0 1 2") == ErrorCode::malformed_input);
  CHECK(with("1 4 0 1 2 3", "1 200 0 1 2") == ErrorCode::invalid_mesh);
  CHECK(with("1 4 0 1 2 3", "1 4 0 1 2 3 9") == ErrorCode::invalid_mesh);
  CHECK(with("30 1 1 0", "30 nan 1 0") == ErrorCode::invalid_mesh);
  CHECK(with("30 1 1 0", "30 1 1e39 0") == ErrorCode::invalid_mesh);
  Bytes nan = binary_tetrahedron(false);
  const float value = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(nan.data() + as_text(nan).find("end_header\n") + 11, &value, 4);
  CHECK(refusal(text_of(nan)) == ErrorCode::invalid_mesh);
}
