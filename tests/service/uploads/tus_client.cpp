#include "tests/service/uploads/tus_client.h"

#include <span>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "proto/messages/base64.h"
#include "server/os/sha256.h"

namespace fairway::test {
namespace {

constexpr const char* kBytesType = "application/offset+octet-stream";

}  // namespace

TusClient::Headers TusClient::with(const Headers& more) const {
  Headers headers = always_;
  headers.insert(more.begin(), more.end());
  return headers;
}

Answer TusClient::create(std::uint64_t length, const Headers& more) const {
  Headers headers = with(more);
  headers.emplace("Upload-Length", std::to_string(length));
  return client_.send("POST", "/v1/uploads", headers);
}

std::string TusClient::created(std::uint64_t length, const Headers& more) const {
  const Answer answer = create(length, more);
  CAPTURE(answer.status, answer.body);
  REQUIRE(answer.status == 201);
  return answer.header("location");
}

Answer TusClient::patch(const std::string& path, std::uint64_t offset, const std::string& bytes,
                        const Headers& more) const {
  Headers headers = with(more);
  headers.emplace("Upload-Offset", std::to_string(offset));
  if (headers.count("Content-Type") == 0) headers.emplace("Content-Type", kBytesType);
  return client_.send("PATCH", path, headers, bytes);
}

Answer TusClient::head(const std::string& path) const {
  return client_.head(path, always_);
}

Answer TusClient::remove(const std::string& path) const {
  return client_.send("DELETE", path, always_);
}

std::uint64_t TusClient::offset(const std::string& path) const {
  const Answer answer = head(path);
  CAPTURE(answer.status);
  REQUIRE(answer.status == 200);
  return std::stoull(answer.header("upload-offset"));
}

std::string TusClient::upload(const std::string& bytes, const Headers& more) const {
  std::string path = created(bytes.size(), more);
  REQUIRE(patch(path, 0, bytes).status == 204);
  return path;
}

std::string id_of_upload(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

std::string metadata_pair(const std::string& key, std::string_view text) {
  return key + " " + encode_base64(std::as_bytes(std::span(text.data(), text.size())));
}

std::string patch_head(const std::string& path, std::uint64_t offset, std::uint64_t length) {
  return fmt::format(
      "PATCH {} HTTP/1.1\r\nHost: t\r\nTus-Resumable: 1.0.0\r\nUpload-Offset: {}\r\n"
      "Content-Type: {}\r\nContent-Length: {}\r\n\r\n",
      path, offset, kBytesType, length);
}

std::string sha256_of(const std::string& text) {
  Sha256 hash;
  hash.update(std::as_bytes(std::span(text)));
  return hash.hex();
}

}  // namespace fairway::test
