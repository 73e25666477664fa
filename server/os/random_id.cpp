#include "server/os/random_id.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include <sys/random.h>

namespace fairway {
namespace {

constexpr std::string_view kAlphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

}  // namespace

void fill_randomly(std::span<std::byte> bytes) {
  // Up to 256 bytes are never cut short once the pool is ready; EINTR happens only before that.
  while (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
  }
}

std::string random_id() {
  std::array<std::uint8_t, 16> bytes{};
  fill_randomly(std::as_writable_bytes(std::span(bytes)));
  std::string text;
  unsigned bits = 0;
  int count = 0;
  for (const std::uint8_t byte : bytes) {
    bits = (bits << 8U) | byte;
    for (count += 8; count >= 6; count -= 6) {
      text += kAlphabet[(bits >> static_cast<unsigned>(count - 6)) & 63U];
    }
  }
  text += kAlphabet[(bits << static_cast<unsigned>(6 - count)) & 63U];
  return text;
}

std::string random_hexadecimal(std::size_t bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::array<std::uint8_t, 256> space{};
  const auto random = std::span(space).first(std::min(bytes, space.size()));
  fill_randomly(std::as_writable_bytes(random));
  std::string text;
  for (const std::uint8_t byte : random) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

bool is_random_id(std::string_view text) {
  return text.size() == kRandomIdLength && std::all_of(text.begin(), text.end(), [](char c) {
           return kAlphabet.find(c) != std::string_view::npos;
         });
}

}  // namespace fairway
