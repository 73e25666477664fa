// Lines, words and numbers of untrusted text.

#include "proto/formats/text_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include "proto/formats/bytes.h"

namespace fairway {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

/// Where the line end at `at` is over: CR LF is one.
std::size_t behind_line_end(std::string_view text, std::size_t at) {
  if (at == text.size()) return at;
  return text[at] == '\r' && at + 1 < text.size() && text[at + 1] == '\n' ? at + 2 : at + 1;
}

template <class Value>
std::string shortest_text(Value value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

/// Of a number that a double does not hold: whether it is too small, not too large.
bool is_tiny(std::string_view word) {
  const std::size_t exponent = word.find_first_of("eE");
  if (exponent != std::string_view::npos) return word.substr(exponent + 1, 1) == "-";
  return word.find_first_not_of("-0") == word.find('.');
}

}  // namespace

bool LineReader::next() {
  if (error_ || at_ >= text_.size()) return false;
  number_ = lines_taken_ + 1;
  const std::size_t begin = at_;
  std::size_t end = begin;
  while (true) {
    // Looking no further than a line may be long bounds the work on one.
    const std::size_t most = std::min(text_.size(), begin + kMostLineBytes + 1);
    while (end < most && text_[end] != '\n' && text_[end] != '\r') ++end;
    if (end - begin > kMostLineBytes) {
      error_ = Error{ErrorCode::too_large,
                     fmt::format("Line {} is longer than {} bytes; break it into shorter ones.",
                                 number_, kMostLineBytes)};
      return false;
    }
    ++lines_taken_;
    at_ = behind_line_end(text_, end);
    const bool joined = continuation_ == Continuation::backslash && end > begin &&
                        text_[end - 1] == '\\' && at_ < text_.size();
    if (!joined) break;
    end = at_;
  }
  line_ = text_.substr(begin, end - begin);
  return true;
}

std::string_view next_word(std::string_view& rest) {
  std::size_t begin = 0;
  const auto joins_lines = [&rest](std::size_t i) {
    return rest[i] == '\\' && i + 1 < rest.size() && (rest[i + 1] == '\n' || rest[i + 1] == '\r');
  };
  while (begin < rest.size() && (is_space(rest[begin]) || joins_lines(begin))) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_space(rest[end]) && !joins_lines(end)) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (auto word = next_word(line); !word.empty(); word = next_word(line)) words.push_back(word);
  return words;
}

std::optional<double> parse_real(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0.0;
  const auto end = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end.ptr != word.data() + word.size()) return std::nullopt;
  if (end.ec == std::errc::result_out_of_range && is_tiny(word)) return 0.0;
  if (end.ec != std::errc() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  std::int64_t value = 0;
  const auto end = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end.ec != std::errc() || end.ptr != word.data() + word.size()) return std::nullopt;
  return value;
}

std::string shortest(float value) {
  return shortest_text(value);
}

std::string shortest(double value) {
  return shortest_text(value);
}

TextPatch::TextPatch(std::string_view source) : source_(source), at_(source.data()) {
  out_.reserve(source.size() + source.size() / 8);
}

void TextPatch::copy_until(const char* end) {
  append(out_, as_bytes({at_, static_cast<std::size_t>(end - at_)}));
  at_ = end;
}

void TextPatch::replace(std::string_view word, std::string_view text) {
  copy_until(word.data());
  append(out_, as_bytes(text));
  at_ = word.data() + word.size();
}

void TextPatch::insert_behind(std::string_view word, std::string_view text) {
  copy_until(word.data() + word.size());
  append(out_, as_bytes(text));
}

std::vector<std::byte> TextPatch::finish() {
  copy_until(source_.data() + source_.size());
  return std::move(out_);
}

}  // namespace fairway
