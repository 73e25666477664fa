#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "core/result.h"

struct evp_md_ctx_st;

namespace fairway {

/// Incremental SHA-256.
class Sha256 {
 public:
  Sha256();
  void update(std::span<const std::byte> bytes);
  /// 64 lower-case hexadecimal digits of all that was given. Once.
  std::string hex();

 private:
  struct Deleter {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Deleter> context_;
};

/// Digest of a whole file, read from its start without moving the descriptor's position.
/// Errors: io.
Result<std::string> sha256_of_file(int fd);

}  // namespace fairway
