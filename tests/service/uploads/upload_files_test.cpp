// Forms with several files: what becomes one payload, and which file is the mesh.

#include <array>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <unistd.h>

#include "proto/messages/bundle.h"
#include "tests/service/support/upload_fixture.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kGltf = R"({"asset":{"version":"2.0"}})";

/// What stands in the draft of an upload.
std::string spooled(const Upload& upload) {
  std::string text(2000, '\0');
  const ssize_t got = ::pread(upload.mesh->descriptor(), text.data(), text.size(), 0);
  REQUIRE(got >= 0);
  text.resize(static_cast<std::size_t>(got));
  return text;
}

/// The name of the mesh that a form is found to have, or the reason for none.
std::string mesh_of(std::vector<Part> parts) {
  UploadFixture f;
  const auto upload = f.multipart(std::move(parts));
  if (!upload) return upload.error().message;
  const std::string payload = spooled(*upload);
  const auto bundle = Bundle::parse(std::as_bytes(std::span(payload)));
  REQUIRE(bundle);
  CHECK(bundle->files().size() == upload->files);
  return bundle->files()[bundle->mesh()].name;
}

Part file(const std::string& name, const std::string& content) {
  return {{"files", name, "application/octet-stream"}, content};
}

}  // namespace

TEST_CASE("a form with one file is spooled as that file") {
  UploadFixture f;
  for (const Part& part : {kMesh, file("a.glb", kGlb), Part{{"scene", "", ""}, kGlb}}) {
    const auto upload = f.multipart({part, {{"params", "", ""}, "{}"}});
    REQUIRE(upload);
    CHECK(upload->files == 1);
    CHECK(spooled(*upload) == kGlb);
  }
}

TEST_CASE("a form with several files is spooled as a bundle in their order") {
  UploadFixture f;
  const auto upload = f.multipart({{{"b.bin", "", ""}, "0123456789abc"},
                                   {{"params", "", ""}, R"({"steps":4})"},
                                   file("scene.gltf", kGltf),
                                   {{"skin", "p/skin.png", "image/png"}, ""}});
  REQUIRE(upload);
  CHECK(upload->format == Format::gltf);
  CHECK(upload->files == 3);
  CHECK(upload->parameters.flow.steps == 4);
  const std::string payload = spooled(*upload);
  CHECK(payload.starts_with("0123456789abc" + kGltf));
  const auto bundle = Bundle::parse(std::as_bytes(std::span(payload)));
  REQUIRE(bundle);
  CHECK(bundle->mesh() == 1);
  CHECK(bundle->files()[0].name == "b.bin");
  CHECK(bundle->files()[0].bytes.size() == 13);
  CHECK(bundle->files()[2].name == "p/skin.png");
  CHECK(bundle->files()[2].bytes.empty());
}

TEST_CASE("the mesh among several files is the plainest candidate, or none") {
  const Part bin = file("b.bin", "0123");
  CHECK(mesh_of({bin, file("s.GLTF", kGltf)}) == "s.GLTF");
  CHECK(mesh_of({bin, file("scene", kGltf)}) == "scene");
  CHECK(mesh_of({file("s.gltf", kGltf), {{"mesh", "t.gltf", ""}, kGltf}}) == "t.gltf");
  CHECK(mesh_of({{{"mesh", "", ""}, kGltf}, file("s.gltf", kGltf)}) == "mesh");
  CHECK(mesh_of({file("s.gltf", kGltf), file("other", kGlb)}) == "s.gltf");
  CHECK(mesh_of({bin, file("c.bin", "4567")}).starts_with("None of"));
  CHECK(mesh_of({file("s.gltf", kGltf), file("t.glb", kGlb)}).starts_with("Several of"));
  CHECK(mesh_of({file("s", kGltf), file("t", kGlb)}).starts_with("Several of"));
}

TEST_CASE("a mesh that is not what its name says is refused among others too") {
  UploadFixture f;
  CHECK(refusal(f.multipart({file("s.gltf", kGlb), file("b.bin", "x")})) ==
        ErrorCode::unsupported_format);
  CHECK(refusal(f.multipart({file("s.gltf", ""), file("b.bin", "x")})) ==
        ErrorCode::malformed_input);
}

TEST_CASE("two parts with one name are refused, and so are impossible names") {
  UploadFixture f;
  const Part bin = file("b.bin", "x");
  CHECK(f.multipart({kMesh, bin}));
  CHECK(refusal(f.multipart({kMesh, bin, bin})) == ErrorCode::bad_request);
  CHECK(refusal(f.multipart({kMesh, bin, {{"b.bin", "", ""}, "y"}})) == ErrorCode::bad_request);
  for (const std::string& name :
       {std::string(256, 'x'), std::string("a\nb"), std::string("\xFF")}) {
    CHECK(refusal(f.multipart({kMesh, file(name, "x")})) == ErrorCode::bad_request);
  }
  CHECK(refusal(f.multipart({kMesh, {{"", "", ""}, "x"}})) == ErrorCode::bad_request);
}

TEST_CASE("a form has at most sixteen parts, the parameters among them") {
  UploadFixture f;
  std::vector<Part> parts = {{{"params", "", ""}, "{}"}, kMesh};
  while (parts.size() < kMaxUploadParts) parts.push_back(file(fmt::to_string(parts.size()), ""));
  CHECK(f.multipart(parts));
  parts.push_back(file("one more", ""));
  CHECK(refusal(f.multipart(parts)) == ErrorCode::bad_request);
  parts.erase(parts.begin());
  CHECK(f.multipart(parts));
}

TEST_CASE("all files of a form together stay within the limit") {
  UploadFixture f;
  const std::string half(UploadFixture::kLimit - kGlb.size(), 'x');
  CHECK(f.multipart({kMesh, file("a", half)}));
  CHECK(refusal(f.multipart({kMesh, file("a", half), file("b", "x")})) == ErrorCode::too_large);
}
