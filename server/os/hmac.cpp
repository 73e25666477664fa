#include "server/os/hmac.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include <openssl/evp.h>
#include <openssl/hmac.h>

#include "server/os/random_id.h"

namespace fairway {
namespace {

using Bytes = std::vector<unsigned char>;

std::string base64_of(std::span<const unsigned char> bytes) {
  // EVP writes a final zero.
  Bytes text(4 * ((bytes.size() + 2) / 3) + 1);
  const int size = EVP_EncodeBlock(text.data(), bytes.data(), static_cast<int>(bytes.size()));
  return {text.begin(), text.begin() + size};
}

std::optional<Bytes> bytes_of(std::string_view base64) {
  if (base64.empty() || base64.size() % 4 != 0 || base64.size() > 1024) return std::nullopt;
  Bytes bytes(base64.size() / 4 * 3);
  const auto* text = reinterpret_cast<const unsigned char*>(base64.data());
  if (EVP_DecodeBlock(bytes.data(), text, static_cast<int>(base64.size())) < 0) {
    return std::nullopt;
  }
  // EVP counts what the padding stands for as bytes.
  const auto padding = std::count(base64.end() - 2, base64.end(), '=');
  bytes.resize(bytes.size() - static_cast<std::size_t>(padding));
  return bytes;
}

}  // namespace

std::string random_base64(std::size_t bytes) {
  Bytes random(std::min<std::size_t>(bytes, 256));
  fill_randomly(std::as_writable_bytes(std::span(random)));
  return base64_of(random);
}

std::optional<std::string> hmac_sha256(std::string_view base64_key, std::string_view text) {
  const auto key = bytes_of(base64_key);
  if (!key) return std::nullopt;
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  const auto* data = reinterpret_cast<const unsigned char*>(text.data());
  if (HMAC(EVP_sha256(), key->data(), static_cast<int>(key->size()), data, text.size(),
           digest.data(), &size) == nullptr) {
    return std::nullopt;
  }
  return base64_of(std::span(digest).first(size));
}

}  // namespace fairway
