#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "server/fairwayd/store/directory_blob_store.h"
#include "server/fairwayd/uploads/upload.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::test {

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
  void interrupt() override {}

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

inline const std::string kGlb = std::string("glTF\x02\0\0\0", 8) + std::string(200, 'x');

/// Receives uploads into a blob store of its own, without a socket.
class UploadFixture {
 public:
  UploadFixture() {
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
    auto upload = receive_upload(request, UploadUse::job, body, *blobs_, kLimit);
    if (!upload) CHECK(std::filesystem::is_empty(directory_.path() / "spool"));
    return upload;
  }
  Result<Upload> multipart(std::vector<Part> parts) {
    return receive(request("multipart/form-data; boundary=x"), PieceBody(std::move(parts)));
  }

  static constexpr std::uint64_t kLimit = 1000;

 private:
  TemporaryDirectory directory_;
  std::unique_ptr<DirectoryBlobStore> blobs_;
};

template <class T>
ErrorCode refusal(const Result<T>& result) {
  REQUIRE_FALSE(result);
  return result.error().code;
}

inline const Part kMesh{{"mesh", "a.glb", ""}, kGlb};

}  // namespace fairway::test
