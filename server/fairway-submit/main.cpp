// Denoises many files by a fairwayd: `fairway submit`, a program of its own so that the tool needs
// no network.

#include <csignal>
#include <cstdio>
#include <exception>

#include <fmt/format.h>

#include "server/fairway-submit/batch.h"
#include "server/fairway-submit/options.h"
#include "server/fairway-submit/summary.h"

namespace fairway {
namespace {

int submit(const SubmitOptions& options) {
  // The TLS library writes to connections that have ended without asking not to be told so.
  std::signal(SIGPIPE, SIG_IGN);
  const auto report = run_batch(options);
  if (!report) {
    fmt::print(stderr, "fairway-submit: {}\n", report.error().message);
    return static_cast<int>(SubmitExit::usage);
  }
  if (!options.quiet) fmt::print(stderr, "{}", summary_text(*report, options));
  if (options.json) {
    constexpr int kIndent = 2;
    fmt::print("{}\n", summary_document(*report, options)
                           .dump(kIndent, ' ', false, Json::error_handler_t::replace));
  }
  return static_cast<int>(report->exit);
}

}  // namespace
}  // namespace fairway

int main(int argc, char** argv) {
  try {
    const auto parsed = fairway::parse_submit_options(argc, argv);
    const auto* options = std::get_if<fairway::SubmitOptions>(&parsed);
    return options != nullptr ? fairway::submit(*options) : std::get<int>(parsed);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "fairway-submit: %s\n", e.what());
    return static_cast<int>(fairway::SubmitExit::usage);
  }
}
