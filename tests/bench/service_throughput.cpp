// How jobs share the processors: the same jobs with one worker and with two, and what the server
// and the clients take beside them.

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "tests/bench/service_bench.h"
#include "tests/bench/service_load.h"

namespace fairway::bench {
namespace {

constexpr double kLeastGain = 1.7;  // jobs a second with two workers, by those with one
/// Batches of jobs for one worker and for two, in turn.
constexpr int kBatches = 5;

using Times = std::vector<double>;

std::vector<Bytes> batch(ServiceBench& bench) {
  std::vector<Bytes> files;
  for (std::size_t i = 0; i < bench.options.batch; ++i) files.push_back(bench.uploads.next());
  return files;
}

/// A figure of each run.
template <class Of>
double median_of(const std::vector<LoadRun>& runs, const Of& of) {
  Times values;
  for (const LoadRun& run : runs) values.push_back(of(run));
  return median(std::move(values));
}

double worker_time(const LoadRun& run) {
  return 1e3 * run.used.workers / static_cast<double>(run.jobs);
}

void report(const std::string& name, const std::vector<LoadRun>& runs, Figures& figures) {
  figures.line("jobs with " + name, median_of(runs, [](const LoadRun& r) { return r.rate(); }),
               "a second");
  const double processors = std::max(1U, std::thread::hardware_concurrency());
  const auto share = [&](double ProcessorTime::*part) {
    return median_of(runs, [&](const LoadRun& run) {
      return 100.0 * run.used.*part / (run.seconds * processors);
    });
  };
  const double ours = share(&ProcessorTime::workers) + share(&ProcessorTime::server) +
                      share(&ProcessorTime::client);
  const double machine = share(&ProcessorTime::machine);
  figures.note(fmt::format(
      "of {} processors: workers {:.0f} %, server {:.0f} %, clients {:.0f} %, other programs "
      "{:.0f} %, idle {:.0f} %; a worker takes {:.0f} ms a job",
      processors, share(&ProcessorTime::workers), share(&ProcessorTime::server),
      share(&ProcessorTime::client), std::max(0.0, machine - ours),
      std::max(0.0, 100.0 - std::max(machine, ours)), median_of(runs, worker_time)));
}

/// Why two workers are not twice one.
void name_what_is_shared(const std::vector<LoadRun>& one, const std::vector<LoadRun>& two,
                         const Figures& figures) {
  const auto part = [&](double ProcessorTime::*of) {
    return median_of(two, [of](const LoadRun& run) {
      return 1e3 * run.used.*of / static_cast<double>(run.jobs);
    });
  };
  const double server = part(&ProcessorTime::server);
  const double clients = part(&ProcessorTime::client);
  const double others = std::max(
      0.0, part(&ProcessorTime::machine) - part(&ProcessorTime::workers) - server - clients);
  const double alone = median_of(one, worker_time);
  const double beside = median_of(two, worker_time);
  figures.note(fmt::format(
      "what two workers share, in processor time a job: server {:.1f} ms, clients {:.1f} ms, "
      "other programs {:.1f} ms; caches and memory: a worker takes {:.1f} ms beside another, "
      "{:.1f} ms alone ({:+.0f} %)",
      server, clients, others, beside, alone, 100.0 * (beside / alone - 1.0)));
}

}  // namespace

Result<void> measure_throughput(ServiceBench& bench) {
  auto first = start_service(bench, "one", 1);
  if (!first) return first.error();
  auto second = start_service(bench, "two", 2);
  if (!second) return second.error();
  std::vector<LoadRun> one;
  std::vector<LoadRun> two;
  Times gains;
  for (int i = 0; i <= kBatches; ++i) {
    const auto with_one = run_load(*first, batch(bench), bench.options.clients);
    if (!with_one) return with_one.error();
    const auto with_two = run_load(*second, batch(bench), bench.options.clients);
    if (!with_two) return with_two.error();
    if (i == 0) continue;  // both are warm now
    one.push_back(*with_one);
    two.push_back(*with_two);
    gains.push_back(with_two->rate() / with_one->rate());
  }
  report("1 worker", one, bench.figures);
  report("2 workers", two, bench.figures);
  bench.figures.line("2 workers by 1", median(gains), "", Limit{Limit::Kind::at_least, kLeastGain});
  if (median(gains) < kLeastGain) name_what_is_shared(one, two, bench.figures);
  return {};
}

}  // namespace fairway::bench
