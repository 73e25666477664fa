#include "server/fairwayd/upload.h"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "server/fairwayd/directory_blob_store.h"
#include "tests/service/temporary_directory.h"

using namespace fairway;

namespace {

struct Part {
  PartHead head;
  std::string content;
};

/// A body that arrives in small pieces.
class PieceBody final : public BodySource {
 public:
  explicit PieceBody(std::string raw) : raw_(std::move(raw)) {}
  explicit PieceBody(std::vector<Part> parts) : parts_(std::move(parts)) {}

  Result<void> read(const OnBytes& on_bytes) override { return pieces(raw_, on_bytes); }
  Result<void> read_parts(const OnPart& on_part, const OnBytes& on_bytes) override {
    for (const Part& part : parts_) {
      if (auto begun = on_part(part.head); !begun) return begun;
      if (auto done = pieces(part.content, on_bytes); !done) return done;
    }
    return {};
  }

 private:
  static Result<void> pieces(std::string_view text, const OnBytes& on_bytes) {
    while (!text.empty()) {
      const std::string_view piece = text.substr(0, 10);
      if (auto said = on_bytes(std::as_bytes(std::span(piece.data(), piece.size()))); !said) {
        return said;
      }
      text.remove_prefix(piece.size());
    }
    return {};
  }

  std::string raw_;
  std::vector<Part> parts_;
};

const std::string kGlb = std::string("glTF\x02\0\0\0", 8) + std::string(200, 'x');

class Fixture {
 public:
  Fixture() {
    auto opened =
        DirectoryBlobStore::open(directory_.path() / "blobs", directory_.path() / "spool");
    REQUIRE(opened);
    blobs_ = std::move(*opened);
  }

  static HttpRequest request(const std::string& type) {
    HttpRequest request;
    request.method = "POST";
    request.path = "/v1/jobs";
    request.content_type = type;
    request.has_length = true;
    return request;
  }
  Result<Upload> receive(const HttpRequest& request, PieceBody body) {
    auto upload = receive_upload(request, body, *blobs_, kLimit);
    if (!upload) CHECK(std::filesystem::is_empty(directory_.path() / "spool"));
    return upload;
  }
  Result<Upload> multipart(std::vector<Part> parts) {
    return receive(request("multipart/form-data; boundary=x"), PieceBody(std::move(parts)));
  }

  static constexpr std::uint64_t kLimit = 1000;

 private:
  test::TemporaryDirectory directory_;
  std::unique_ptr<DirectoryBlobStore> blobs_;
};

template <class T>
ErrorCode refusal(const Result<T>& result) {
  REQUIRE_FALSE(result);
  return result.error().code;
}

const Part kMesh{{"mesh", "a.glb", ""}, kGlb};

}  // namespace

TEST_CASE("a raw upload becomes a spooled mesh with its parameters") {
  Fixture f;
  HttpRequest request = Fixture::request("model/gltf-binary");
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
  Fixture f;
  const Part params{{"params", "", "application/json"}, R"({"steps":4})"};
  for (const auto& parts : {std::vector<Part>{kMesh, params}, std::vector<Part>{params, kMesh}}) {
    const auto upload = f.multipart(parts);
    REQUIRE(upload);
    CHECK(upload->parameters.flow.steps == 4);
  }
}

TEST_CASE("a multipart upload has exactly one mesh, at most one params, and nothing else") {
  Fixture f;
  const Part params{{"params", "", ""}, "{}"};
  CHECK(refusal(f.multipart({})) == ErrorCode::bad_request);
  CHECK(refusal(f.multipart({params})) == ErrorCode::bad_request);
  CHECK(refusal(f.multipart({kMesh, kMesh})) == ErrorCode::bad_request);
  CHECK(refusal(f.multipart({kMesh, params, params})) == ErrorCode::bad_request);
  CHECK(refusal(f.multipart({kMesh, {{"other", "", ""}, "x"}})) == ErrorCode::bad_request);
}

TEST_CASE("an upload above the limit is refused while it streams") {
  Fixture f;
  CHECK(refusal(f.receive(Fixture::request("model/gltf-binary"),
                          PieceBody(kGlb + std::string(1000, 'x')))) == ErrorCode::too_large);
  const Part long_params{{"params", "", ""}, std::string(kMaxParameterBytes + 1, ' ')};
  CHECK(refusal(f.multipart({long_params, kMesh})) == ErrorCode::too_large);
}

TEST_CASE("a declared type that the first bytes contradict is refused") {
  Fixture f;
  CHECK(refusal(f.receive(Fixture::request("model/gltf+json"), PieceBody(kGlb))) ==
        ErrorCode::unsupported_format);
  CHECK(refusal(f.receive(Fixture::request("model/gltf-binary"),
                          PieceBody(std::string(80, 'P')))) == ErrorCode::unsupported_format);
  CHECK(refusal(f.multipart({{{"mesh", "a.glb", "image/png"}, kGlb}})) ==
        ErrorCode::unsupported_format);
}

TEST_CASE("an empty upload is refused") {
  Fixture f;
  CHECK(refusal(f.receive(Fixture::request("model/gltf-binary"), PieceBody(std::string()))) ==
        ErrorCode::malformed_input);
}

TEST_CASE("wrong parameters are refused wherever they stand") {
  Fixture f;
  CHECK(refusal(f.multipart({kMesh, {{"params", "", ""}, R"({"stepz":1})"}})) ==
        ErrorCode::invalid_parameters);
  CHECK(refusal(f.multipart({kMesh, {{"params", "", ""}, "{"}})) ==
        ErrorCode::malformed_parameters);
}

TEST_CASE("what the head of a request tells is refused before its body is read") {
  const auto check = [](auto change) {
    HttpRequest request = Fixture::request("model/gltf-binary");
    change(request);
    return refusal(check_upload(request, Fixture::kLimit));
  };
  CHECK(check_upload(Fixture::request("model/gltf-binary"), Fixture::kLimit));
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
