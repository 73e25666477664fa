#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace fairway {

// Every format here is little-endian; values are copied as they stand in memory.
static_assert(std::endian::native == std::endian::little);

using ByteSpan = std::span<const std::byte>;

/// a · b, or nothing where it does not fit in 64 bits.
std::optional<std::uint64_t> checked_multiply(std::uint64_t a, std::uint64_t b);

/// a + b, or nothing where it does not fit in 64 bits.
std::optional<std::uint64_t> checked_add(std::uint64_t a, std::uint64_t b);

/// Bytes that `count` elements of `size`, `stride` apart, take from `offset` to the end of the last
/// one; nothing where that does not fit in 64 bits. 0 elements take `offset`.
std::optional<std::uint64_t> strided_end(std::uint64_t offset, std::uint64_t count,
                                         std::uint64_t stride, std::uint64_t size);

/// The value at `data`, which may be unaligned.
template <class T>
T load(const std::byte* data) {
  static_assert(std::is_trivially_copyable_v<T>);
  T value;
  std::memcpy(&value, data, sizeof value);
  return value;
}

template <class T>
void append_value(std::vector<std::byte>& out, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

void append(std::vector<std::byte>& out, ByteSpan bytes);

/// Adds `fill` up to the next multiple of four.
void align_to_four(std::vector<std::byte>& out, std::byte fill = std::byte{0});

std::string_view as_text(ByteSpan bytes);
ByteSpan as_bytes(std::string_view text);

/// Reads little-endian values from the front of untrusted bytes; nothing at the end of them.
class ByteReader {
 public:
  explicit ByteReader(ByteSpan bytes) : rest_(bytes) {}

  std::size_t remaining() const { return rest_.size(); }
  std::optional<ByteSpan> take(std::uint64_t count);

  template <class T>
  std::optional<T> read() {
    const std::optional<ByteSpan> bytes = take(sizeof(T));
    if (!bytes) return std::nullopt;
    return load<T>(bytes->data());
  }

  /// Draco's varint: seven bits per byte, low bits first; nothing where it needs more than 64 bits.
  std::optional<std::uint64_t> read_varint();

 private:
  ByteSpan rest_;
};

}  // namespace fairway
