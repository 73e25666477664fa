#include "proto/formats/byte_chain.h"

#include <array>
#include <utility>

namespace fairway {

void ByteChain::append_view(ByteSpan bytes) {
  if (bytes.empty()) return;
  pieces_.push_back(bytes);
  size_ += bytes.size();
}

void ByteChain::append(std::vector<std::byte> bytes) {
  const auto owner = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  append_view(*owner);
  keep(owner);
}

void ByteChain::append(std::string text) {
  const auto owner = std::make_shared<const std::string>(std::move(text));
  append_view(as_bytes(*owner));
  keep(owner);
}

void ByteChain::append(const ByteChain& chain) {
  for (const ByteSpan piece : chain.pieces_) append_view(piece);
  owners_.insert(owners_.end(), chain.owners_.begin(), chain.owners_.end());
}

void ByteChain::align_to_four() {
  static constexpr std::array<std::byte, 3> kZeros{};
  append_view(ByteSpan(kZeros).first((4 - size_ % 4) % 4));
}

std::vector<std::byte> ByteChain::joined() const {
  std::vector<std::byte> out;
  out.reserve(size_);
  for (const ByteSpan piece : pieces_) fairway::append(out, piece);
  return out;
}

}  // namespace fairway
