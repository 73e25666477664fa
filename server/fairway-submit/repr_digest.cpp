#include "server/fairway-submit/repr_digest.h"

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::string_view kBegin = "sha-256=:";
constexpr std::string_view kAlphabet =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::size_t kDigits = 64;

}  // namespace

std::optional<std::string> sha256_of_repr_digest(std::string_view field) {
  const std::size_t at = field.find(kBegin);
  if (at == std::string_view::npos) return std::nullopt;
  field.remove_prefix(at + kBegin.size());
  field = field.substr(0, field.find(':'));
  std::string text;
  unsigned bits = 0;
  int count = 0;
  for (const char c : field.substr(0, field.find('='))) {
    const std::size_t value = kAlphabet.find(c);
    if (value == std::string_view::npos) return std::nullopt;
    bits = (bits << 6U | static_cast<unsigned>(value)) & 0xFFFU;
    for (count += 6; count >= 8; count -= 8) {
      text += fmt::format("{:02x}", bits >> static_cast<unsigned>(count - 8) & 0xFFU);
    }
  }
  return text.size() == kDigits ? std::optional(text) : std::nullopt;
}

}  // namespace fairway
