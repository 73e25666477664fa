#include "server/fairwayd/uploads/upload.h"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "tests/service/support/upload_fixture.h"

using namespace fairway;
using namespace fairway::test;

TEST_CASE("a raw upload becomes a spooled mesh with its parameters") {
  UploadFixture f;
  HttpRequest request = UploadFixture::request("model/gltf-binary");
  request.query = {{"params", R"({"steps":3})"}};
  const auto upload = f.receive(request, PieceBody(kGlb));
  REQUIRE(upload);
  CHECK(upload->format == Format::glb);
  CHECK(upload->parameters.flow.steps == 3);
  const auto blob = upload->mesh->commit("x");
  REQUIRE(blob);
  CHECK(blob->bytes == kGlb.size());
}

TEST_CASE("a multipart upload may have its parts in any order") {
  UploadFixture f;
  const Part params{{"params", "", "application/json"}, R"({"steps":4})"};
  for (const auto& parts : {std::vector<Part>{kMesh, params}, std::vector<Part>{params, kMesh}}) {
    const auto upload = f.multipart(parts);
    REQUIRE(upload);
    CHECK(upload->parameters.flow.steps == 4);
  }
}

TEST_CASE("a multipart upload has a mesh, at most one part mesh and at most one params") {
  UploadFixture f;
  const Part params{{"params", "", ""}, "{}"};
  const Part other_mesh{{"mesh", "b.glb", ""}, kGlb};
  CHECK(refusal(f.multipart({})) == ErrorCode::bad_request);
  CHECK(refusal(f.multipart({params})) == ErrorCode::bad_request);
  CHECK(refusal(f.multipart({kMesh, other_mesh})) == ErrorCode::bad_request);
  CHECK(refusal(f.multipart({kMesh, params, params})) == ErrorCode::bad_request);
}

TEST_CASE("an upload above the limit is refused while it streams") {
  UploadFixture f;
  CHECK(refusal(f.receive(UploadFixture::request("model/gltf-binary"),
                          PieceBody(kGlb + std::string(1000, 'x')))) == ErrorCode::too_large);
  const Part long_params{{"params", "", ""}, std::string(kMaxParameterBytes + 1, ' ')};
  CHECK(refusal(f.multipart({long_params, kMesh})) == ErrorCode::too_large);
}

TEST_CASE("a declared type that the first bytes contradict is refused") {
  UploadFixture f;
  CHECK(refusal(f.receive(UploadFixture::request("model/gltf+json"), PieceBody(kGlb))) ==
        ErrorCode::unsupported_format);
  CHECK(refusal(f.receive(UploadFixture::request("model/gltf-binary"),
                          PieceBody(std::string(80, 'P')))) == ErrorCode::unsupported_format);
  CHECK(refusal(f.multipart({{{"mesh", "a.glb", "image/png"}, kGlb}})) ==
        ErrorCode::unsupported_format);
}

TEST_CASE("an empty upload is refused") {
  UploadFixture f;
  CHECK(refusal(f.receive(UploadFixture::request("model/gltf-binary"), PieceBody(std::string()))) ==
        ErrorCode::malformed_input);
}

TEST_CASE("wrong parameters are refused wherever they stand") {
  UploadFixture f;
  CHECK(refusal(f.multipart({kMesh, {{"params", "", ""}, R"({"stepz":1})"}})) ==
        ErrorCode::invalid_parameters);
  CHECK(refusal(f.multipart({kMesh, {{"params", "", ""}, "{"}})) ==
        ErrorCode::malformed_parameters);
}

TEST_CASE("what the head of a request tells is refused before its body is read") {
  const auto check = [](auto change) {
    HttpRequest request = UploadFixture::request("model/gltf-binary");
    change(request);
    return refusal(check_upload(request, UploadUse::job, UploadFixture::kLimit));
  };
  CHECK(check_upload(UploadFixture::request("model/gltf-binary"), UploadUse::job,
                     UploadFixture::kLimit));
  CHECK(check([](HttpRequest& r) { r.has_content_encoding = true; }) ==
        ErrorCode::unsupported_format);
  CHECK(check([](HttpRequest& r) { r.has_length = false; }) == ErrorCode::length_required);
  CHECK(check([](HttpRequest& r) { r.content_length = 1001; }) == ErrorCode::too_large);
  CHECK(check([](HttpRequest& r) { r.query = {{"param", "{}"}}; }) == ErrorCode::bad_request);
  CHECK(check([](HttpRequest& r) {
          r.query = {{"params", "{}"}, {"params", "{}"}};
        }) == ErrorCode::bad_request);
  CHECK(check([](HttpRequest& r) {
          r.query = {{"params", "{"}};
        }) == ErrorCode::malformed_parameters);
  CHECK(check([](HttpRequest& r) {
          r.query = {{"params", R"({"stepz":1})"}};
        }) == ErrorCode::invalid_parameters);
}
