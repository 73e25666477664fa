#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "proto/formats/bytes.h"

namespace fairway {

/// Bytes in pieces, joined once where they are written: nothing is copied to be appended.
class ByteChain {
 public:
  std::size_t size() const { return size_; }
  std::span<const ByteSpan> pieces() const { return pieces_; }

  /// `bytes` must outlive the chain.
  void append_view(ByteSpan bytes);
  void append(std::vector<std::byte> bytes);
  /// Zeros up to the next multiple of four.
  void align_to_four();

  /// All pieces in one.
  std::vector<std::byte> joined() const;

 private:
  std::size_t size_ = 0;
  std::vector<ByteSpan> pieces_;
  std::deque<std::vector<std::byte>> owned_;
};

}  // namespace fairway
