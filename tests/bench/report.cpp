#include "tests/bench/report.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include <fmt/format.h>
#include <sys/resource.h>

namespace fairway::bench {

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Times in_turn(int runs, const std::function<void()>& ours, const std::function<void()>& baseline) {
  constexpr double kLong = std::numeric_limits<double>::max();
  Times least{kLong, baseline ? kLong : 0.0};
  for (int i = 0; i < runs; ++i) {
    least.ours = std::min(least.ours, seconds_of(ours));
    if (baseline) least.baseline = std::min(least.baseline, seconds_of(baseline));
  }
  return least;
}

Report::Report(const Settings& settings) : settings_(settings) {
  if (settings_.json) return;
  fmt::print("{:<14}{:>10} {:<9}{:>12}{:>12}{:>8}{:>9}{:>10}\n", "stage", "vertices", "order",
             "ns/vertex", "plain", "ratio", "bytes/v", "peak MB");
}

void Report::line(const Case& c, const Times& times) const {
  const auto per_vertex = [&c](double seconds) {
    return seconds * 1e9 / static_cast<double>(c.vertices);
  };
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  const double ratio = times.baseline > 0.0 ? times.baseline / times.ours : 0.0;
  if (settings_.json) {
    fmt::print(
        R"({{"name":"{}","vertices":{},"order":"{}","threads":{},"isa":"{}","ns_per_vertex":{:.2f},)"
        R"("baseline":{},"ratio":{},"bytes_per_vertex":{:.1f},"peak_rss":{}}})"
        "\n",
        c.name, c.vertices, c.order, settings_.threads, settings_.isa, per_vertex(times.ours),
        times.baseline > 0.0 ? fmt::format("{:.2f}", per_vertex(times.baseline)) : "null",
        ratio > 0.0 ? fmt::format("{:.3f}", ratio) : "null", c.bytes_per_vertex,
        usage.ru_maxrss * 1024);
  } else {
    fmt::print("{:<14}{:>10} {:<9}{:>12.1f}{:>12.1f}{:>8.2f}{:>9.0f}{:>10}\n", c.name, c.vertices,
               c.order, per_vertex(times.ours), per_vertex(times.baseline), ratio,
               c.bytes_per_vertex, usage.ru_maxrss / 1024);
  }
  std::fflush(stdout);
}

}  // namespace fairway::bench
