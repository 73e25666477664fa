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
  CHECK_FALSE(format_of_file_name("glb"));
  CHECK_FALSE(format_of_file_name("x.png"));
}

}  // namespace fairway::test
