// OBJ and STL have no magic; what they begin with tells them apart from anything else.

#include "proto/messages/shape_guess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace fairway {
namespace {

constexpr std::string_view kSpaces = " \t\r\n\v\f";
constexpr std::size_t kStlFirstTriangle = 84;
constexpr std::size_t kStlTriangleBytes = 50;

constexpr std::array<std::string_view, 14> kObjKeywords = {
    "v", "vn", "vt", "vp", "f", "l", "p", "g", "o", "s", "usemtl", "mtllib", "mg", "usemap"};

/// Without control characters; bytes above ASCII are taken for UTF-8 or the like.
bool is_text(std::string_view head) {
  return std::all_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x20U || kSpaces.find(c) != std::string_view::npos;
  });
}

bool is_obj(std::string_view head) {
  if (!is_text(head)) return false;
  bool has_comment = false;
  while (true) {
    const std::size_t begin = head.find_first_not_of(kSpaces);
    // Nothing but comments is how some exporters begin.
    if (begin == std::string_view::npos) return has_comment;
    head.remove_prefix(begin);
    if (head.front() == '#') {
      has_comment = true;
      head.remove_prefix(std::min(head.find_first_of("\r\n"), head.size()));
      continue;
    }
    const std::string_view word = head.substr(0, head.find_first_of(kSpaces));
    return std::find(kObjKeywords.begin(), kObjKeywords.end(), word) != kObjKeywords.end();
  }
}

bool is_binary_stl(std::span<const std::byte> head) {
  if (head.size() < kStlFirstTriangle + kStlTriangleBytes) return false;
  std::uint32_t count = 0;
  std::array<float, 12> values{};
  std::memcpy(&count, head.data() + kStlFirstTriangle - sizeof count, sizeof count);
  std::memcpy(values.data(), head.data() + kStlFirstTriangle, sizeof values);
  constexpr float kMost = 1e18F;
  constexpr float kLeast = 1e-18F;
  const bool sane = std::all_of(values.begin(), values.end(), [](float v) {
    return v == 0.0F || (std::abs(v) < kMost && std::abs(v) > kLeast);
  });
  if (count == 0 || !sane) return false;
  const float length = std::hypot(values[0], values[1], values[2]);
  return length == 0.0F || std::abs(length - 1.0F) < 0.01F;
}

}  // namespace

std::optional<Format> guess_shape(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  if (is_binary_stl(head)) return Format::stl;
  if (text.substr(0, 5) == "solid") return Format::stl;
  if (is_obj(text)) return Format::obj;
  return std::nullopt;
}

}  // namespace fairway
