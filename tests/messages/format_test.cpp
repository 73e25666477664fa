// Which format some bytes are.

#include "proto/messages/format.h"

#include <string>

#include <catch2/catch.hpp>

namespace fairway::test {
namespace {

Result<Format> recognise(const std::string& bytes, const char* type, const char* name = "") {
  return recognise_format(std::as_bytes(std::span(bytes)), type, name);
}

const std::string kGlb("glTF\x02\0\0\0\x0c\0\0\0", 12);
const std::string kDraco("DRACO\x02\x02\x01\x01\0\0", 11);
/// One triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) without a normal.
std::string binary_stl() {
  std::string out(134, '\0');
  out.replace(0, 6, "header");
  out[80] = 1;
  out.replace(84 + 24, 4, std::string("\0\0\x80\x3F", 4));
  out.replace(84 + 40, 4, std::string("\0\0\x80\x3F", 4));
  return out;
}

const std::string kPng("\x89PNG\r\n\x1a\n", 8);

}  // namespace

TEST_CASE("formats are recognised by magic, whatever octet-stream or nothing is declared") {
  for (const char* type : {"", "application/octet-stream", "Application/Octet-Stream; a=b"}) {
    CHECK(*recognise(kGlb, type) == Format::glb);
    CHECK(*recognise(kDraco, type) == Format::drc);
    CHECK(*recognise(" \n{\"asset\":{}}", type) == Format::gltf);
    CHECK(*recognise("\xEF\xBB\xBF{}", type) == Format::gltf);
  }
}

TEST_CASE("PLY, OBJ and STL are recognised by what they begin with") {
  for (const char* type : {"", "application/octet-stream"}) {
    CHECK(*recognise("ply\nformat ascii 1.0\n", type) == Format::ply);
    CHECK(*recognise("ply\r\nformat ascii 1.0\r\n", type) == Format::ply);
    CHECK(*recognise("solid thing\nfacet", type) == Format::stl);
    CHECK(*recognise("# made by\n\nmtllib a.mtl\n", type) == Format::obj);
    CHECK(*recognise("v 0 0 0\r\n", type) == Format::obj);
    CHECK(*recognise(binary_stl(), type) == Format::stl);
  }
  for (const char* bytes : {"OFF\n3 1 0\n", "<html>", "vertex", "plyx"}) {
    CAPTURE(bytes);
    CHECK(recognise(bytes, "").error().code == ErrorCode::unsupported_format);
  }
  CHECK_FALSE(recognise(std::string("v\0 0 0 0", 8), ""));
  std::string no_triangle = binary_stl();
  no_triangle[84 + 7] = '\x7F';
  CHECK_FALSE(recognise(no_triangle, ""));
  no_triangle = binary_stl();
  no_triangle[80] = 0;
  CHECK_FALSE(recognise(no_triangle, ""));
}

TEST_CASE("OBJ and STL are believed by type or name where the bytes are no other format") {
  const std::string unknown(100, '\x01');
  CHECK(*recognise(unknown, "model/stl") == Format::stl);
  CHECK(*recognise(unknown, "application/sla; x=y") == Format::stl);
  CHECK(*recognise("call other.obj\n", "model/obj") == Format::obj);
  CHECK(*recognise(unknown, "", "part.STL") == Format::stl);
  CHECK(*recognise("ply\n", "application/ply") == Format::ply);
  for (const char* type : {"model/stl", "model/obj", "model/gltf-binary"}) {
    CHECK(recognise("ply\n", type).error().code == ErrorCode::unsupported_format);
    CHECK_FALSE(recognise("", type));
  }
  CHECK(recognise(kGlb, "", "part.stl").error().code == ErrorCode::unsupported_format);
  CHECK(recognise("v 0 0 0\n", "model/ply").error().code == ErrorCode::unsupported_format);
  CHECK(recognise("v 0 0 0\n", "", "part.glb").error().code == ErrorCode::unsupported_format);
}

TEST_CASE("a declared type that the bytes contradict is an unsupported format") {
  const auto refused = [](const std::string& bytes, const char* type) {
    const Result<Format> format = recognise(bytes, type, "mesh.glb");
    REQUIRE_FALSE(format);
    CHECK(format.error().code == ErrorCode::unsupported_format);
  };
  refused(kPng, "model/gltf-binary");
  refused(kDraco, "model/gltf-binary");
  refused("{}", "model/gltf-binary");
  refused(kGlb, "model/gltf+json");
  refused(kPng, "model/gltf+json");
  refused(kGlb, "image/png");
  refused(kPng, "");
}

TEST_CASE("a file name that the bytes contradict is an unsupported format") {
  CHECK(recognise("{}", "", "mesh.drc").error().code == ErrorCode::unsupported_format);
  CHECK(recognise(kGlb, "application/octet-stream", "mesh.GLTF").error().code ==
        ErrorCode::unsupported_format);
  CHECK(recognise(kGlb, "", "mesh.bin"));
}

TEST_CASE("versions fairway does not read are unsupported formats") {
  CHECK(recognise(std::string("glTF\x01\0\0\0", 8), "").error().code ==
        ErrorCode::unsupported_format);
  CHECK(recognise(std::string("DRACO\x09\x09", 7), "").error().code ==
        ErrorCode::unsupported_format);
}

TEST_CASE("nothing, and a magic cut short, are malformed") {
  for (const char* bytes : {"", "g", "glT", "DRAC"}) {
    CHECK(recognise(bytes, "model/gltf-binary").error().code == ErrorCode::malformed_input);
  }
}

TEST_CASE("file names name formats by their extension in any case") {
  CHECK(format_of_file_name("a.b.GLB") == Format::glb);
  CHECK(format_of_file_name("x.gltf") == Format::gltf);
  CHECK(format_of_file_name("x.drc") == Format::drc);
  CHECK(format_of_file_name("x.Ply") == Format::ply);
  CHECK(format_of_file_name("x.obj") == Format::obj);
  CHECK(format_of_file_name("x.STL") == Format::stl);
  CHECK_FALSE(format_of_file_name("glb"));
  CHECK_FALSE(format_of_file_name("x.png"));
}

TEST_CASE("a type that a browser guessed for a mesh is passed over, one of another kind is not") {
  const std::string cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  CHECK(*recognise(cube, "application/x-tgif", "a.obj") == Format::obj);
  CHECK(*recognise(cube, "text/plain", "A.OBJ") == Format::obj);
  CHECK_FALSE(recognise(cube, "application/x-tgif", "a.doc"));
  CHECK_FALSE(recognise(cube, "application/x-tgif", ""));
  CHECK_FALSE(recognise(cube, "image/png", "a.obj"));
  // The bytes have the last word.
  CHECK_FALSE(recognise("glTF" + std::string(20, 'x'), "application/x-tgif", "a.obj"));
}

}  // namespace fairway::test
