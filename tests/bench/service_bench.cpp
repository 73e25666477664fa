// Benchmarks of the service: what it adds to a run of the tool, how jobs share the processors, and
// what memory stays.

#include "tests/bench/service_bench.h"

#include <algorithm>
#include <csignal>
#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tests/bench/service_load.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::bench {
namespace {

constexpr double kMostGrowth = 32.0;  // MiB
constexpr double kMebi = 1024.0 * 1024.0;

/// What of fairwayd is resident after many jobs, each deleted by its client.
Result<void> measure_memory(ServiceBench& bench) {
  auto service = start_service(bench, "memory");
  if (!service) return service.error();
  const auto resident = [&] { return static_cast<double>(service->resident_bytes()) / kMebi; };
  const double start = resident();
  bench.figures.line("memory of fairwayd at its start", start, "MiB");
  const std::size_t half = bench.options.jobs / 2;
  const auto send = [&](std::size_t jobs) {
    return run_jobs(*service, bench.uploads, jobs, bench.options.clients);
  };
  if (auto done = send(half); !done) return done;
  bench.figures.line(fmt::format("after {} jobs", half), resident(), "MiB");
  if (auto done = send(bench.options.jobs - half); !done) return done;
  bench.figures.line(fmt::format("after {} jobs", bench.options.jobs), resident(), "MiB",
                     Limit{Limit::Kind::at_most, start + kMostGrowth});
  return {};
}

Result<void> run(const ServiceOptions& options) {
  const test::TemporaryDirectory folder;
  Uploads uploads(options.vertices);
  if (!options.json) fmt::print("a GLB of {} vertices\n", uploads.vertices());
  Figures figures(options.json);
  ServiceBench bench{options, folder.path(), uploads, figures};
  const auto measure = [&](const std::string& part, Result<void> (*run_part)(ServiceBench&)) {
    const bool wanted = options.only.empty() || std::find(options.only.begin(), options.only.end(),
                                                          part) != options.only.end();
    return wanted ? run_part(bench) : Result<void>();
  };
  if (auto done = measure("latency", measure_latency); !done) return done;
  if (auto done = measure("throughput", measure_throughput); !done) return done;
  if (auto done = measure("memory", measure_memory); !done) return done;
  figures.summary();
  return {};
}

}  // namespace

Result<MeasuredProcess> start_service(const ServiceBench& bench, const std::string& name,
                                      std::optional<unsigned> workers) {
  std::vector<std::string> arguments = {"--data", bench.folder / name, "--listen", "127.0.0.1:0"};
  if (workers) arguments.insert(arguments.end(), {"--workers", fmt::to_string(*workers)});
  return MeasuredProcess::start(FAIRWAY_SERVER, std::move(arguments),
                                bench.folder / (name + ".log"));
}

}  // namespace fairway::bench

int main(int argc, char** argv) {
  fairway::bench::ServiceOptions options;
  CLI::App app("Benchmarks of the service", "service_bench");
  app.add_flag("--json", options.json, "One JSON line per figure");
  app.add_option("--rounds", options.rounds, "Rounds of latency")->check(CLI::Range(1, 10'000));
  app.add_option("--size", options.vertices, "Number of vertices")
      ->check(CLI::Range(100, 2'000'000));
  app.add_option("--jobs", options.jobs, "Jobs before memory is looked at")
      ->check(CLI::Range(2, 1'000'000));
  app.add_option("--batch", options.batch, "Jobs of a batch of throughput")
      ->check(CLI::Range(1, 1'000));
  app.add_option("--clients", options.clients, "Clients at a time")->check(CLI::Range(1, 64));
  app.add_option("--only", options.only, "Only these: latency, throughput, memory")
      ->delimiter(',')
      ->check(CLI::IsMember({"latency", "throughput", "memory"}));
  app.add_flag("--no-peer", options.no_peer, "Without the Python service");
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGPIPE, SIG_IGN);
  const auto done = fairway::bench::run(options);
  if (done) return 0;
  fmt::print(stderr, "service_bench: {}\n", done.error().message);
  return 1;
}
