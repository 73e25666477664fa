// Little-endian bytes and arithmetic that cannot wrap.

#include "proto/formats/bytes.h"

namespace fairway {

std::optional<std::uint64_t> checked_multiply(std::uint64_t a, std::uint64_t b) {
  std::uint64_t out = 0;
  if (__builtin_mul_overflow(a, b, &out)) return std::nullopt;
  return out;
}

std::optional<std::uint64_t> checked_add(std::uint64_t a, std::uint64_t b) {
  std::uint64_t out = 0;
  if (__builtin_add_overflow(a, b, &out)) return std::nullopt;
  return out;
}

std::optional<std::uint64_t> strided_end(std::uint64_t offset, std::uint64_t count,
                                         std::uint64_t stride, std::uint64_t size) {
  if (count == 0) return offset;
  const auto last = checked_multiply(count - 1, stride);
  if (!last) return std::nullopt;
  const auto end = checked_add(*last, size);
  if (!end) return std::nullopt;
  return checked_add(offset, *end);
}

void append(std::vector<std::byte>& out, ByteSpan bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void align_to_four(std::vector<std::byte>& out, std::byte fill) {
  out.resize((out.size() + 3) / 4 * 4, fill);
}

std::string_view as_text(ByteSpan bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

ByteSpan as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

std::optional<ByteSpan> ByteReader::take(std::uint64_t count) {
  if (count > rest_.size()) return std::nullopt;
  const ByteSpan taken = rest_.first(static_cast<std::size_t>(count));
  rest_ = rest_.subspan(taken.size());
  return taken;
}

std::optional<std::uint64_t> ByteReader::read_varint() {
  std::uint64_t out = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    const auto byte = read<std::uint8_t>();
    if (!byte) return std::nullopt;
    const std::uint64_t bits = *byte & 0x7FU;
    if (shift == 63 && bits > 1) return std::nullopt;
    out |= bits << shift;
    if ((*byte & 0x80U) == 0) return out;
  }
  return std::nullopt;
}

}  // namespace fairway
