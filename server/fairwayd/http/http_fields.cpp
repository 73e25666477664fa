// The small grammar that header fields share (RFC 9110, 5.6).
#include "server/fairwayd/http/http_fields.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <ctime>
#include <system_error>

namespace fairway {
namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool is_token_char(char c) {
  constexpr std::string_view kMarks = "!#$%&'*+-.^_`|~";
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
         kMarks.find(c) != std::string_view::npos;
}

/// The content of a whole quoted string.
std::optional<std::string> unquoted(std::string_view text) {
  if (text.size() < 2 || text.front() != '"' || text.back() != '"') return std::nullopt;
  text = text.substr(1, text.size() - 2);
  std::string content;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') return std::nullopt;
    if (text[i] == '\\' && ++i == text.size()) return std::nullopt;
    content += text[i];
  }
  return content;
}

}  // namespace

std::string_view trim_blanks(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), lower);
  return out;
}

bool is_token(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), is_token_char);
}

std::vector<std::string_view> split_field(std::string_view value, char separator) {
  std::vector<std::string_view> elements;
  bool quoted = false;
  std::size_t begin = 0;
  const auto close = [&](std::size_t end) {
    const std::string_view element = trim_blanks(value.substr(begin, end - begin));
    if (!element.empty()) elements.push_back(element);
    begin = end + 1;
  };
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!quoted && value[i] == separator) close(i);
    if (value[i] == '"') quoted = !quoted;
    if (quoted && value[i] == '\\') ++i;
  }
  close(value.size());
  return elements;
}

std::optional<NamedWord> named_word(std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string_view name = trim_blanks(text.substr(0, equals));
  if (!is_token(name)) return std::nullopt;
  if (equals == std::string_view::npos) return NamedWord{lower_case(name), ""};
  const std::string_view value = trim_blanks(text.substr(equals + 1));
  if (value.empty() || is_token(value)) return NamedWord{lower_case(name), std::string(value)};
  auto content = unquoted(value);
  if (!content) return std::nullopt;
  return NamedWord{lower_case(name), *std::move(content)};
}

std::optional<std::uint64_t> digits_value(std::string_view text) {
  const bool digits = !text.empty() && std::all_of(text.begin(), text.end(),
                                                   [](char c) { return c >= '0' && c <= '9'; });
  if (!digits) return std::nullopt;
  std::uint64_t value = 0;
  const auto status = std::from_chars(text.data(), text.data() + text.size(), value).ec;
  return status == std::errc::result_out_of_range ? UINT64_MAX : value;
}

std::string http_date(std::int64_t unix_millis) {
  constexpr std::int64_t kSecond = 1000;
  const std::time_t seconds = unix_millis / kSecond;
  std::tm date{};
  ::gmtime_r(&seconds, &date);
  std::array<char, 64> text{};
  // Names of days are English: no program here sets a locale.
  const std::size_t length =
      std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &date);
  return {text.data(), length};
}

}  // namespace fairway
