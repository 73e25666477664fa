// Kills, stops and crowds the service, and checks that it keeps what it has promised. The last line
// is "N of M": trials passed, trials made.
#include <algorithm>
#include <chrono>
#include <optional>
#include <random>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tests/chaos/scenarios.h"
#include "tests/chaos/watchdog.h"
#include "tests/one_line_reporter.h"

namespace fairway::chaos {
namespace {

/// The counts that the service is held to: uploads, accepted jobs, running jobs, and one each of
/// what is only to be there.
constexpr std::size_t kPromised = 50 + 100 + 50 + 7;

// The helpers need a test case around them; the options come from the command line.
const Options* chosen_options = nullptr;
Trials* all_trials = nullptr;

bool is_wanted(const Scenario& scenario, const Options& options) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), scenario.name) != options.only.end();
}

void run_scenario(const Scenario& scenario, Trials& trials, Workshop& workshop) {
  const auto began = std::chrono::steady_clock::now();
  const std::size_t count = scenario.scales ? trials.scaled(scenario.count) : scenario.count;
  const std::size_t passed = trials.passed();
  trials.enter(scenario.name);
  scenario.run(trials, workshop, count);
  const std::size_t done = trials.done_in(scenario.name);
  fmt::print("{:<15} {:>3} of {:<3} {:6.1f} s  {}\n", scenario.name, trials.passed() - passed, done,
             milliseconds_since(began) / 1000.0, scenario.what);
  std::fflush(stdout);
}

TEST_CASE("the service keeps its promises") {
  Workshop workshop;
  for (const Scenario& scenario : scenarios()) {
    if (is_wanted(scenario, *chosen_options)) run_scenario(scenario, *all_trials, workshop);
  }
}

/// What a whole run must have tried; empty where it has.
std::string missing(const Trials& trials, const Options& options) {
  for (const Scenario& scenario : scenarios()) {
    if (!is_wanted(scenario, options)) continue;
    const std::size_t wanted = scenario.scales ? trials.scaled(scenario.count) : scenario.count;
    if (trials.done_in(scenario.name) < wanted) {
      return fmt::format("{} made {} trials of {}", scenario.name, trials.done_in(scenario.name),
                         wanted);
    }
  }
  const bool whole = options.only.empty() && options.scale >= 1.0;
  if (whole && trials.done() < kPromised + kill_point_trials()) return "too few trials were made";
  return {};
}

int run(const Options& options) {
  Trials trials(options);
  chosen_options = &options;
  all_trials = &trials;
  fmt::print("seed {}\n", options.seed);
  handle_interrupts();
  const auto began = std::chrono::steady_clock::now();
  Catch::Session session;
  session.configData().reporterName = "one-line";
  const int status = session.run();
  trials.print_measures();
  const std::string lacking = missing(trials, options);
  if (!lacking.empty()) fmt::print("BROKEN suite: {}\n", lacking);
  fmt::print("{:.0f} s\n{} of {}\n", milliseconds_since(began) / 1000.0, trials.passed(),
             trials.done());
  return status == 0 && lacking.empty() && trials.passed() == trials.done() ? 0 : 1;
}

}  // namespace
}  // namespace fairway::chaos

int main(int count, char** arguments) {
  using namespace fairway::chaos;
  CLI::App app("Kills, stops and crowds fairwayd, and checks that it keeps what it has promised.");
  Options options;
  options.seed = std::random_device()();
  std::vector<std::string> names;
  for (const Scenario& scenario : scenarios()) names.emplace_back(scenario.name);
  app.add_option("--seed", options.seed, "Repeats the choices of a run");
  app.add_option("--scale", options.scale, "Times each count of trials")
      ->check(CLI::Range(0.001, 100.0));
  app.add_option("--patience", options.patience, "Times each bound, for machines under load")
      ->check(CLI::Range(1.0, 1000.0));
  app.add_option("--only", options.only, "Scenarios")->check(CLI::IsMember(names));
  CLI11_PARSE(app, count, arguments);
  return run(options);
}
