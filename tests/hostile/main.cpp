// Hostile inputs, hostile clients and mutated meshes against the real service. The last line is
// "N of M": cases passed, cases made.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "tests/hostile/attacks.h"
#include "tests/hostile/canaries.h"
#include "tests/hostile/mutants.h"
#include "tests/hostile/shared_cases.h"
#include "tests/hostile/wire.h"
#include "tests/one_line_reporter.h"

namespace fairway::hostile {
namespace {

/// Cases of a whole run, at least.
constexpr std::size_t kPromised = 247;

struct Options {
  MutantOptions mutants;
  double patience = 1.0;
  std::vector<std::string> only;
};

// The helpers need a test case around them; the options come from the command line.
const Options* chosen = nullptr;
Score* score = nullptr;

bool is_wanted(std::string_view part) {
  return chosen->only.empty() ||
         std::find(chosen->only.begin(), chosen->only.end(), part) != chosen->only.end();
}

/// A part that cannot even begin is one failed case.
template <class Part>
void begin(std::string_view name, const Part& part) {
  if (!is_wanted(name)) return;
  const auto began = std::chrono::steady_clock::now();
  try {
    part();
  } catch (const Broken& broken) {
    score->run(std::string(name), [&] { throw broken; });
  }
  score->tell(fmt::format("{}: {:.0f} s", name, milliseconds_since(began) / 1000.0));
}

void run_shared() {
  const auto cases = shared_cases();
  if (!cases) {
    score->tell("the collection of hostile inputs is not there: none of its cases was run");
    return;
  }
  begin("shared", [&] { run_shared_cases(*score, *cases, chosen->patience); });
  begin("traced", [&] { run_traced_cases(*score, *cases); });
}

TEST_CASE("the service withstands") {
  if (is_wanted("shared") || is_wanted("traced")) run_shared();
  begin("canaries", [] { run_canaries(*score); });
  begin("walls", [] { run_worker_walls(*score); });
  for (const Attack& attack : attacks()) {
    begin(attack.name, [&] { run_attack(*score, attack, chosen->patience); });
  }
  begin("mutations", [] { run_mutants(*score, chosen->mutants); });
}

int run(const Options& options) {
  Score all;
  chosen = &options;
  score = &all;
  fmt::print("seed {}\n", options.mutants.seed);
  const auto began = std::chrono::steady_clock::now();
  Catch::Session session;
  session.configData().reporterName = "one-line";
  const int status = session.run();
  all.print_table();
  const bool whole = options.only.empty();
  const bool enough = !whole || all.done() >= kPromised;
  if (!enough) fmt::print("FAILED suite: {} cases, {} are promised\n", all.done(), kPromised);
  fmt::print("{:.0f} s\n{} of {}\n", milliseconds_since(began) / 1000.0, all.passed(), all.done());
  return status == 0 && enough && all.done() > 0 && all.passed() == all.done() ? 0 : 1;
}

/// Crowds need more descriptors than a shell usually gives.
void raise_descriptor_limit() {
  constexpr rlim_t kWanted = 4096;
  rlimit limit{};
  ::getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = std::min(std::max(limit.rlim_cur, kWanted), limit.rlim_max);
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace
}  // namespace fairway::hostile

int main(int count, char** arguments) {
  using namespace fairway::hostile;
  CLI::App app(
      "Sends hostile inputs, attacks and mutated meshes to fairwayd, and checks that it "
      "withstands.");
  Options options;
  std::vector<std::string> names = {"shared", "traced", "canaries", "walls", "mutations"};
  for (const Attack& attack : attacks()) names.emplace_back(attack.name);
  app.add_option("--mutations", options.mutants.count, "Mutated meshes (20000)")
      ->check(CLI::Range(8, 10000000));
  app.add_option("--seed", options.mutants.seed, "Of the mutations (1)");
  app.add_option("--in-flight", options.mutants.in_flight, "Workers at a time (2)")
      ->check(CLI::Range(1, 64));
  app.add_option("--patience", options.patience, "Times each bound, for machines under load")
      ->check(CLI::Range(1.0, 1000.0));
  app.add_option("--only", options.only, "Parts and attacks")->check(CLI::IsMember(names));
  CLI11_PARSE(app, count, arguments);
  raise_descriptor_limit();
  std::signal(SIGPIPE, SIG_IGN);
  return run(options);
}
