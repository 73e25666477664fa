#include "server/fairwayd/settings/setting_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "server/fairwayd/api/cross_origin.h"

namespace fairway {
namespace {

constexpr std::uint64_t kAnyBytes = std::uint64_t{1} << 48;
constexpr std::uint64_t kDay = 86'400;

const std::array kRows = {
    SettingRow{"data", "DIR", "Where jobs and meshes are kept; made where absent", &Settings::data},
    SettingRow{"listen", "HOST:PORT", "Address of the HTTP API; port 0 = any free one",
               &Settings::listen},
    SettingRow{"admin-listen", "HOST:PORT",
               "A second address, for /metrics and administration; then they are only there",
               &Settings::admin_listen},
    SettingRow{"auth", "auto|keys|none",
               "Whether callers need a key (fairwayd keys); auto: refuse to listen beyond this "
               "machine",
               &Settings::auth},
    SettingRow{"cors-origins", "ORIGINS",
               "Sites whose pages may use the API, with commas between them; * = all",
               &Settings::cors_origins},
    SettingRow{"workers", "N", "Jobs that run at a time", &Settings::workers, 1, 1024},
    SettingRow{"queue", "N", "Jobs that may wait; more are answered 429", &Settings::queue, 1,
               1'000'000},
    SettingRow{"rate", "N", "Submits of a tenant in a minute; more are answered 429; 0 = any",
               &Settings::rate, 0, 1'000'000},
    SettingRow{"quota", "BYTES", "Meshes kept of one tenant; more are answered 507; 0 = any",
               &Settings::quota, 0, kAnyBytes},
    SettingRow{"max-body", "BYTES", "Largest mesh", &Settings::max_body, 1, kAnyBytes},
    SettingRow{"deadline", "SECONDS", "Longest run of one job", &Settings::deadline, 1, kDay},
    SettingRow{"lease", "SECONDS", "A server that is silent for longer loses the jobs it runs",
               &Settings::lease, 3, kDay},
    SettingRow{"keep", "SECONDS", "How long meshes are kept after a job's end", &Settings::keep, 1,
               365 * kDay},
    SettingRow{"upload-keep", "SECONDS",
               "How long an upload in pieces waits for its next one, or to become a job",
               &Settings::upload_keep, 1, 365 * kDay},
    SettingRow{"forget", "SECONDS", "How long an ended job itself is known", &Settings::forget, 1,
               3650 * kDay},
    SettingRow{"worker-memory", "BYTES", "Address space of one job; 0 = any",
               &Settings::worker_memory, 0, kAnyBytes},
    SettingRow{"min-free", "BYTES",
               "Disk space to leave below --data; with less, uploads are answered 507",
               &Settings::min_free, 0, kAnyBytes},
    SettingRow{"drain", "SECONDS", "How long running jobs may take to end when the service stops",
               &Settings::drain, 0, kDay},
    SettingRow{"worker", "PATH", "The fairway program; default: beside fairwayd",
               &Settings::worker},
    SettingRow{"webhook-allow-private", "yes|no",
               "Whether webhooks may be in networks that are not public, this machine included",
               &Settings::webhook_allow_private},
    SettingRow{"webhook-retry", "SECONDS",
               "First delay of a webhook's nine retries; the others, up to a day for 5, grow with "
               "it; 0 = all at once",
               &Settings::webhook_retry, 0, kDay},
};

struct AuthName {
  AuthMode mode;
  std::string_view name;
};
constexpr std::array kAuthNames = {AuthName{AuthMode::automatic, "auto"},
                                   AuthName{AuthMode::keys, "keys"},
                                   AuthName{AuthMode::none, "none"}};

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

Error usage(std::string sentence) {
  return {ErrorCode::usage, std::move(sentence)};
}

Result<std::uint64_t> number_in(const SettingRow& row, std::string_view text) {
  std::uint64_t number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, number);
  if (status == std::errc() && stop == end && number >= row.low && number <= row.high) {
    return number;
  }
  return usage(
      fmt::format("takes a whole number from {} to {}, not \"{}\".", row.low, row.high, text));
}

Result<ListenAddress> address_in(std::string_view text) {
  auto address = parse_listen_address(text);
  if (address) return address;
  return usage(fmt::format("takes HOST:PORT, such as 127.0.0.1:8080, not \"{}\".", text));
}

Result<bool> choice_in(std::string_view text) {
  if (text == "yes" || text == "no") return text == "yes";
  return usage(fmt::format("takes yes or no, not \"{}\".", text));
}

Result<AuthMode> auth_in(std::string_view text) {
  for (const AuthName& each : kAuthNames) {
    if (each.name == text) return each.mode;
  }
  return usage(fmt::format("takes auto, keys or none, not \"{}\".", text));
}

std::string_view auth_name(AuthMode mode) {
  return kAuthNames[static_cast<std::size_t>(mode)].name;
}

/// Puts a value where it belongs, or says why there is none.
template <class Value, class Target>
Result<void> put(Result<Value> value, Target& target) {
  if (!value) return value.error();
  target = Target(*std::move(value));
  return {};
}

}  // namespace

std::span<const SettingRow> setting_rows() {
  return kRows;
}

const SettingRow* find_setting(std::string_view name) {
  const auto* row = std::find_if(kRows.begin(), kRows.end(),
                                 [name](const SettingRow& each) { return each.name == name; });
  return row == kRows.end() ? nullptr : row;
}

std::string flag_of(const SettingRow& row) {
  return "--" + std::string(row.name);
}

std::string variable_of(const SettingRow& row) {
  std::string name = "FAIRWAY_";
  for (const char c : row.name) {
    name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return name;
}

Result<void> assign(Settings& settings, const SettingRow& row, std::string_view text) {
  // A line end inside a value could forge a line of what --print-config prints.
  if (std::any_of(text.begin(), text.end(),
                  [](char c) { return std::iscntrl(static_cast<unsigned char>(c)) != 0; })) {
    return usage("takes no control characters.");
  }
  return std::visit(
      Overloaded{
          [&](std::uint64_t Settings::*to) { return put(number_in(row, text), settings.*to); },
          [&](std::chrono::seconds Settings::*to) {
            return put(number_in(row, text), settings.*to);
          },
          [&](std::filesystem::path Settings::*to) {
            settings.*to = text;
            return Result<void>();
          },
          [&](ListenAddress Settings::*to) { return put(address_in(text), settings.*to); },
          [&](AuthMode Settings::*to) { return put(auth_in(text), settings.*to); },
          [&](std::vector<std::string> Settings::*to) {
            return put(parse_origins(text), settings.*to);
          },
          [&](std::optional<ListenAddress> Settings::*to) {
            if (!text.empty()) return put(address_in(text), settings.*to);
            (settings.*to).reset();
            return Result<void>();
          },
          [&](bool Settings::*to) { return put(choice_in(text), settings.*to); }},
      row.target);
}

std::string text_of(const Settings& settings, const SettingRow& row) {
  return std::visit(
      Overloaded{[&](std::uint64_t Settings::*from) { return fmt::to_string(settings.*from); },
                 [&](std::chrono::seconds Settings::*from) {
                   return fmt::to_string((settings.*from).count());
                 },
                 [&](std::filesystem::path Settings::*from) { return (settings.*from).string(); },
                 [&](ListenAddress Settings::*from) { return to_string(settings.*from); },
                 [&](AuthMode Settings::*from) { return std::string(auth_name(settings.*from)); },
                 [&](std::vector<std::string> Settings::*from) {
                   return fmt::format("{}", fmt::join(settings.*from, ","));
                 },
                 [&](std::optional<ListenAddress> Settings::*from) {
                   return settings.*from ? to_string(*(settings.*from)) : std::string();
                 },
                 [&](bool Settings::*from) { return std::string(settings.*from ? "yes" : "no"); }},
      row.target);
}

}  // namespace fairway
