// The command line of fairwayd.

#include "server/fairwayd/settings.h"

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>

namespace fairway {
namespace {

constexpr std::uint64_t kAnyBytes = std::uint64_t{1} << 48;

/// Options that write into `settings` and `listen`.
struct CommandLine {
  CommandLine() {
    settings.workers = std::max(1U, std::thread::hardware_concurrency());
    app.set_help_flag();
    app.add_flag("--help,-h", settings.help, "Print this and exit");
    app.add_flag("--version", settings.version, "Print the version and exit");
    app.add_option("--data", settings.data, "Where jobs and meshes are kept; made where absent")
        ->type_name("DIR");
    app.add_option("--listen", listen, "Address of the HTTP API; port 0 = any free one")
        ->type_name("HOST:PORT")
        ->capture_default_str();
    number("--workers", settings.workers, "Jobs that run at a time", 1, 1024);
    number("--queue", settings.queue, "Jobs that may wait; more are answered 429", 1, 1'000'000);
    number("--max-body", settings.max_body, "Largest mesh in bytes", 1, kAnyBytes);
    number("--deadline", deadline, "Longest run of one job in seconds", 1, 86'400);
    number("--worker-memory", settings.worker_memory, "Address space of one job in bytes; 0 = any",
           0, kAnyBytes);
    app.add_option("--worker", settings.worker, "The fairway program; default: beside fairwayd")
        ->type_name("PATH");
    app.footer(
        "\nSIGTERM and SIGINT stop it; running jobs go back to the queue and are done after the "
        "next start.");
  }

  template <class Number>
  void number(const std::string& name, Number& target, const std::string& help, std::uint64_t low,
              std::uint64_t high) {
    app.add_option(name, target, help)
        ->check(CLI::Range(static_cast<Number>(low), static_cast<Number>(high)))
        ->type_name("N")
        ->capture_default_str();
  }

  CLI::App app{"fairwayd: the mesh-denoising service", "fairwayd"};
  Settings settings;
  std::string listen = to_string(ListenAddress{});
  std::uint64_t deadline = static_cast<std::uint64_t>(Settings{}.deadline.count());
};

Error usage(const std::string& message) {
  return {ErrorCode::usage, message + " See fairwayd --help."};
}

}  // namespace

Result<Settings> parse_settings(std::span<const char* const> arguments) {
  CommandLine line;
  // CLI11 takes the arguments from the back.
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    line.app.parse(reversed);
  } catch (const CLI::ParseError& e) {
    return usage(std::string(e.what()) + ".");
  }
  Settings settings = std::move(line.settings);
  if (settings.help || settings.version) return settings;
  if (settings.data.empty()) return usage("--data DIR is needed: where jobs and meshes are kept.");
  settings.deadline = std::chrono::seconds(line.deadline);
  Result<ListenAddress> address = parse_listen_address(line.listen);
  if (!address) return address.error();
  settings.listen = *std::move(address);
  return settings;
}

std::string usage_text() {
  return CommandLine().app.help();
}

}  // namespace fairway
