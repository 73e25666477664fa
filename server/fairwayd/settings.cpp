#include "server/fairwayd/settings.h"

#include <array>
#include <charconv>
#include <string>
#include <thread>

#include <fmt/format.h>

namespace fairway {
namespace {

Error usage(std::string message) {
  return {ErrorCode::usage, std::move(message)};
}

struct Range {
  std::uint64_t least;
  std::uint64_t most;
};

Result<std::uint64_t> number(std::string_view name, std::string_view text, Range range) {
  std::uint64_t value = 0;
  const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || stop != text.data() + text.size() || value < range.least ||
      value > range.most) {
    return usage(
        fmt::format("{} takes a whole number from {} to {}.", name, range.least, range.most));
  }
  return value;
}

constexpr std::uint64_t kAnyBytes = std::uint64_t{1} << 48;

/// An option with a number, its range and its place.
struct NumberOption {
  std::string_view name;
  Range range;
  void (*set)(Settings&, std::uint64_t);
};

constexpr std::array<NumberOption, 5> kNumbers{{
    {"--workers", {1, 1024}, [](Settings& s, std::uint64_t n) { s.workers = n; }},
    {"--queue", {1, 1000000}, [](Settings& s, std::uint64_t n) { s.queue = n; }},
    {"--max-body", {1, kAnyBytes}, [](Settings& s, std::uint64_t n) { s.max_body = n; }},
    {"--deadline",
     {1, 86400},
     [](Settings& s, std::uint64_t n) { s.deadline = std::chrono::seconds(n); }},
    {"--worker-memory", {0, kAnyBytes}, [](Settings& s, std::uint64_t n) { s.worker_memory = n; }},
}};

Result<void> set(Settings& settings, std::string_view name, std::string_view value) {
  for (const NumberOption& option : kNumbers) {
    if (option.name != name) continue;
    auto parsed = number(name, value, option.range);
    if (!parsed) return parsed.error();
    option.set(settings, *parsed);
    return {};
  }
  if (name == "--listen") {
    auto address = parse_listen_address(value);
    if (!address) return address.error();
    settings.listen = *address;
  } else if (name == "--data") {
    settings.data = value;
  } else if (name == "--worker") {
    settings.worker = value;
  } else {
    return usage(fmt::format("{} is not an option of fairwayd: see fairwayd --help.", name));
  }
  return {};
}

}  // namespace

Result<Settings> parse_settings(std::span<const char* const> arguments) {
  Settings settings;
  settings.workers = std::max(1U, std::thread::hardware_concurrency());
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view name = arguments[i];
    if (name == "--help" || name == "-h") {
      settings.help = true;
      return settings;
    }
    if (name == "--version") {
      settings.version = true;
      return settings;
    }
    if (!name.starts_with("--")) {
      return usage(fmt::format("{} is not an option of fairwayd: see fairwayd --help.", name));
    }
    if (i + 1 == arguments.size()) return usage(fmt::format("{} needs a value.", name));
    if (auto done = set(settings, name, arguments[++i]); !done) return done.error();
  }
  if (settings.data.empty()) {
    return usage("--data DIR is needed: where jobs and meshes are kept.");
  }
  return settings;
}

std::string_view usage_text() {
  return R"(fairwayd: the mesh-denoising service.

usage: fairwayd --data DIR [options]

  --data DIR             where jobs and meshes are kept; made where it is absent
  --listen HOST:PORT     address of the HTTP API (127.0.0.1:8080; port 0 = any free one)
  --workers N            jobs that run at a time (one per processor)
  --queue N              jobs that may wait; more are answered 429 (256)
  --max-body BYTES       largest mesh (536870912)
  --deadline SECONDS     longest run of one job (300)
  --worker-memory BYTES  address space of one job, 0 = any (4294967296)
  --worker PATH          the fairway program (beside fairwayd)
  --help, --version

SIGTERM and SIGINT stop it; running jobs go back to the queue and are done after the next start.
)";
}

}  // namespace fairway
