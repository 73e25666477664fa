#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "proto/formats/bytes.h"

namespace fairway {

/// Bytes in pieces, for whoever writes them: nothing is copied to be appended.
class ByteChain {
 public:
  ByteChain() = default;
  explicit ByteChain(std::vector<std::byte> bytes) { append(std::move(bytes)); }

  std::size_t size() const { return size_; }
  std::span<const ByteSpan> pieces() const { return pieces_; }

  /// `bytes` must outlive the chain.
  void append_view(ByteSpan bytes);
  void append(std::vector<std::byte> bytes);
  void append(std::string text);
  void append(const ByteChain& chain);
  /// Zeros up to the next multiple of four.
  void align_to_four();
  /// What views refer to then lives as long as the chain and its copies.
  void keep(std::shared_ptr<const void> owner) { owners_.push_back(std::move(owner)); }

  /// All pieces in one.
  std::vector<std::byte> joined() const;

 private:
  std::size_t size_ = 0;
  std::vector<ByteSpan> pieces_;
  std::vector<std::shared_ptr<const void>> owners_;
};

}  // namespace fairway
