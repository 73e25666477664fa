#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

struct evp_md_ctx_st;

namespace fairway {

/// What a client may check its bytes with. SHA-1 tells accidents only, never an attacker.
enum class ChecksumAlgorithm : std::uint8_t { sha1, sha256 };

/// A checksum of bytes as they come.
class Checksum {
 public:
  explicit Checksum(ChecksumAlgorithm algorithm);
  void update(std::span<const std::byte> bytes);
  /// The 20 or 32 bytes of it. Once.
  std::vector<std::byte> finish();

 private:
  struct Deleter {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Deleter> context_;
};

}  // namespace fairway
