#include <catch2/catch.hpp>

#include "proto/formats/bytes.h"
#include "proto/formats/document.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kObj =
    "# a \\ comment\r\nmtllib nowhere.mtl\no thing\nv 0.000 0 0 1 0.5 0.5\nv 1 0 0\nvt 0 0\n"
    "vn 0 0 1\nusemtl red\nv 1 1 0\nv 0 1 0\ng one\ns 1\nf 1/1/1 2/1/1 3/1/1 \\\n 4/1/1\n"
    "vn 0 0 -2\nv 0.5 0.5 1\ng two\nf -5//-1 -1//-1 -4//-1\nl 1 2\np 1\nwhatever else";

std::string text_of(const Bytes& bytes) {
  return std::string(as_text(bytes));
}

ErrorCode refusal(const std::string& obj) {
  const Bytes bytes = text_bytes(obj);
  const auto document = decode(bytes, Format::obj);
  REQUIRE_FALSE(document);
  CHECK(document.error().message.size() > 20);
  return document.error().code;
}

}  // namespace

TEST_CASE("an OBJ comes back with only its vertices and normals replaced") {
  const auto document = decoded(text_bytes(kObj), Format::obj);
  const Surface& surface = document->surfaces().at(0);
  CHECK(surface.mesh.positions.size() == 5);
  CHECK(surface.mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 4, 1}});
  CHECK(text_of(*document->encode(unmoved(*document), Format::obj)) == kObj);
  // Nothing turns: the normals stay as they are, and so does what did not move.
  auto results = shifted(*document, Vec3(0, 0, 0.1));
  std::string expected = kObj;
  const auto replace = [&expected](const std::string& old, const std::string& now) {
    expected.replace(expected.find(old), old.size(), now);
  };
  replace("v 0.000 0 0 1", "v 0 0 0.1 1");
  replace("v 1 0 0\n", "v 1 0 0.1\n");
  replace("v 1 1 0\n", "v 1 1 0.1\n");
  replace("v 0 1 0\n", "v 0 1 0.1\n");
  replace("v 0.5 0.5 1\n", "v 0.5 0.5 1.1\n");
  const std::string out = text_of(*document->encode(results, Format::obj));
  const auto without_normals = [](std::string text) {
    for (std::size_t at = text.find("vn "); at != std::string::npos; at = text.find("vn ", at)) {
      text.erase(at, text.find('\n', at) - at);
    }
    return text;
  };
  CHECK(without_normals(out) == without_normals(expected));
}

TEST_CASE("normals of an OBJ follow the faces that name them, on the side where they were") {
  const auto document = decoded(
      text_bytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 -1\nvn 9 9 9\nf 1//1 2//1 3//2\n"),
      Format::obj);
  auto results = unmoved(*document);
  results[0].moved = true;
  results[0].positions = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CHECK(text_of(*document->encode(results, Format::obj)) ==
        "v 0 0 0\nv 0 1 0\nv 0 0 1\nvn 1 0 0\nvn -1 -0 -0\nvn 9 9 9\nf 1//1 2//1 3//2\n");
}

TEST_CASE("coordinates far from the origin keep the digits of a double") {
  const auto document = decoded(
      text_bytes("v 500000.125 5000000.25 0\nv 500001 5000000 0\nv 500000 5000001 0\nf 1 2 3\n"),
      Format::obj);
  const std::string out =
      text_of(*document->encode(shifted(*document, Vec3(0.0625, 0, 0)), Format::obj));
  CHECK(out.rfind("v 500000.1875 5000000.25 0\nv 500001.0625 ", 0) == 0);
}

TEST_CASE("broken lines of an OBJ are refused") {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  CHECK(refusal(three) == ErrorCode::no_triangles);
  CHECK(refusal("") == ErrorCode::no_triangles);
  for (const char* line :
       {"f 1 2", "f 1 2 0", "f 1 2 4", "f 1 2 -4", "f 1 2 -9223372036854775808", "f 1 2 x",
        "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1 2 3/1/1/1", "f 1 2 99999999999999", "f /1 2 3",
        "v 1 2\nf 1 2 3", "v 1 2 nan\nf 1 2 3", "v 1 2 1e999\nf 1 2 3", "vn 1 2\nf 1 2 3"}) {
    CAPTURE(line);
    CHECK(refusal(three + line + "\n") == ErrorCode::invalid_mesh);
  }
  CHECK(refusal(three + "f " + std::string(std::size_t{5} << 20U, '1')) == ErrorCode::too_large);
  const Bytes later = text_bytes("f 1 2 3\n" + three);
  CHECK(decode(later, Format::obj));
}
