#include "server/fairwayd/settings/settings_file.h"

#include <algorithm>
#include <cerrno>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "server/os/file.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxFileBytes = 64 * 1024;
constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

bool has_comment_behind(std::string_view value) {
  for (std::size_t at = value.find('#'); at != std::string_view::npos; at = value.find('#', at + 1))
    if (at == 0 || kBlanks.find(value[at - 1]) != std::string_view::npos) return true;
  return false;
}

/// Errors: a sentence without its subject, the line.
Result<SettingLine> parse_line(std::string_view line, std::size_t number) {
  const std::size_t equals = line.find('=');
  const std::string_view name = trimmed(line.substr(0, equals));
  if (equals == std::string_view::npos || name.empty()) {
    return Error{ErrorCode::usage, "is not of the form name = value."};
  }
  const std::string_view value = trimmed(line.substr(equals + 1));
  if (has_comment_behind(value)) {
    return Error{ErrorCode::usage, "has a # behind its value: put comments on lines of their own."};
  }
  return SettingLine{std::string(name), std::string(value), number};
}

}  // namespace

Result<std::vector<SettingLine>> parse_settings_file(std::string_view text, std::string_view file) {
  std::vector<SettingLine> lines;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.empty() || line.front() == '#') continue;
    auto parsed = parse_line(line, number);
    if (!parsed) {
      return Error{ErrorCode::usage, fmt::format("{}:{} {}", file, number, parsed.error().message)};
    }
    const auto same = std::find_if(lines.begin(), lines.end(), [&](const SettingLine& before) {
      return before.name == parsed->name;
    });
    if (same != lines.end()) {
      return Error{ErrorCode::usage, fmt::format("{}:{} sets {} again, after line {}.", file,
                                                 number, same->name, same->line)};
    }
    lines.push_back(*std::move(parsed));
  }
  return lines;
}

Result<std::vector<SettingLine>> read_settings_file(const std::filesystem::path& file) {
  auto fd = open_file(file, O_RDONLY);
  if (!fd) return fd.error();
  std::string text(kMaxFileBytes + 1, '\0');
  std::size_t size = 0;
  while (size < text.size()) {
    const ssize_t got = ::read(fd->get(), text.data() + size, text.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return file_error(fmt::format("read {}", file.string()), errno);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  if (size > kMaxFileBytes) {
    return Error{ErrorCode::usage,
                 fmt::format("{} is longer than {} bytes.", file.string(), kMaxFileBytes)};
  }
  text.resize(size);
  return parse_settings_file(text, file.string());
}

}  // namespace fairway
