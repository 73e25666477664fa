// Strict base64 and the data URIs of self-contained glTF. Source: RFC 4648 section 4, RFC 2397.

#include "proto/messages/base64.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

namespace fairway {
namespace {

constexpr std::string_view kAlphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t kNoDigit = 0xFF;

constexpr std::array<std::uint8_t, 256> kDigits = [] {
  std::array<std::uint8_t, 256> digits{};
  digits.fill(kNoDigit);
  for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
    digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  }
  return digits;
}();

bool equal_ignoring_case(std::string_view text, std::string_view lower) {
  if (text.size() != lower.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (std::tolower(static_cast<unsigned char>(text[i])) != lower[i]) return false;
  }
  return true;
}

void append_quantum(std::uint32_t bits, std::size_t bytes, std::vector<std::byte>& out) {
  for (std::size_t i = 0; i < bytes; ++i) out.push_back(std::byte((bits >> (16 - 8 * i)) & 0xFFU));
}

}  // namespace

std::optional<std::vector<std::byte>> decode_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::size_t padding = 0;
  while (padding < 2 && padding < text.size() && text[text.size() - 1 - padding] == '=') ++padding;
  std::vector<std::byte> out;
  out.reserve(text.size() / 4 * 3);
  for (std::size_t i = 0; i < text.size(); i += 4) {
    const std::size_t digits = i + 4 == text.size() ? 4 - padding : 4;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint8_t digit = k < digits ? kDigits[static_cast<unsigned char>(text[i + k])] : 0;
      if (digit == kNoDigit) return std::nullopt;
      bits = bits << 6U | digit;
    }
    const std::uint32_t unused = digits == 3 ? 0xFFU : digits == 2 ? 0xFFFFU : 0U;
    if ((bits & unused) != 0) return std::nullopt;
    append_quantum(bits, digits - 1, out);
  }
  return out;
}

std::string encode_base64(std::span<const std::byte> bytes) {
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (k < count ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += k <= count ? kAlphabet[(bits >> (18 - 6 * k)) & 0x3FU] : '=';
    }
  }
  return out;
}

bool is_data_uri(std::string_view uri) {
  return equal_ignoring_case(uri.substr(0, 5), "data:");
}

std::optional<std::string_view> data_uri_payload(std::string_view uri) {
  constexpr std::string_view kBase64 = ";base64";
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
  const std::string_view type = uri.substr(0, comma);
  if (type.size() < kBase64.size() ||
      !equal_ignoring_case(type.substr(type.size() - kBase64.size()), kBase64)) {
    return std::nullopt;
  }
  return uri.substr(comma + 1);
}

std::string make_data_uri(std::span<const std::byte> bytes, std::string_view media_type) {
  return "data:" + std::string(media_type) + ";base64," + encode_base64(bytes);
}

}  // namespace fairway
