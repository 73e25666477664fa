#include "proto/formats/byte_chain.h"

#include <array>
#include <utility>

namespace fairway {

void ByteChain::append_view(ByteSpan bytes) {
  pieces_.push_back(bytes);
  size_ += bytes.size();
}

void ByteChain::append(std::vector<std::byte> bytes) {
  owned_.push_back(std::move(bytes));
  append_view(owned_.back());
}

void ByteChain::align_to_four() {
  static constexpr std::array<std::byte, 3> kZeros{};
  const std::size_t missing = (4 - size_ % 4) % 4;
  if (missing > 0) append_view(ByteSpan(kZeros).first(missing));
}

std::vector<std::byte> ByteChain::joined() const {
  std::vector<std::byte> out;
  out.reserve(size_);
  for (const ByteSpan piece : pieces_) fairway::append(out, piece);
  return out;
}

}  // namespace fairway
