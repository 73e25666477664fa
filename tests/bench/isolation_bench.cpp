// What it costs that a job has a confined process of its own: the same mesh denoised in this
// process, by a worker that stood by, and by one that had to be started, in turns.

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "core/shapes.h"
#include "proto/formats/fresh_mesh.h"
#include "server/fairway/pipeline.h"
#include "server/fairwayd/work/worker_run.h"
#include "server/os/file.h"
#include "server/os/memory.h"
#include "tests/bench/figures.h"
#include "tests/bench/report.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::bench {
namespace {

constexpr double kMostFixed = 10.0;  ///< ms
constexpr double kMostShare = 0.05;  ///< of the job in process
constexpr double kMilli = 1e3;

struct Options {
  std::vector<std::size_t> sizes = {36, 35'000};
  int rounds = 31;
  bool json = false;
};

std::vector<std::byte> noisy_glb(std::size_t vertices) {
  const auto tube = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(vertices) / 2.0)));
  Surface surface;
  surface.mesh = with_normal_noise(torus(2 * tube, tube, 1.0, 0.4), 0.2, 1);
  return write_fresh_mesh(surface, {}, Format::glb, {})->bytes.joined();
}

/// Until a worker stands by, started and waiting for its order.
void let_it_get_ready() {
  std::this_thread::sleep_for(std::chrono::milliseconds(60));
}

class IsolationBench {
 public:
  IsolationBench(std::size_t vertices, int rounds, Figures& figures)
      : mesh_(noisy_glb(vertices)),
        rounds_(rounds),
        figures_(figures),
        input_(*open_file(folder_.path() / "input", O_RDWR | O_CREAT)),
        flag_(*EventFlag::create()) {
    if (!write_all(input_.get(), mesh_)) std::abort();
  }

  /// False where a job failed.
  bool run(const std::string& name) {
    if (!pool_.start()) return false;
    std::vector<double> alone;
    std::vector<double> warm;
    std::vector<double> cold;
    std::vector<double> cost;
    for (int round = 0; round < rounds_; ++round) {
      alone.push_back(kMilli * seconds_of([this] { in_process(); }));
      let_it_get_ready();
      warm.push_back(kMilli * seconds_of([this] { by_worker(pool_); }));
      cold.push_back(kMilli * seconds_of([this] { by_worker(cold_pool_); }));
      cost.push_back(warm.back() - alone.back());
    }
    if (failed_) return false;
    const double job = median(alone);
    figures_.line(name + ": in process", job, "ms");
    figures_.line(name + ": by a waiting worker", median(warm), "ms");
    figures_.line(name + ": by a worker to be started", median(cold), "ms");
    figures_.line(name + ": cost of isolation", median(cost), "ms",
                  Limit{Limit::Kind::at_most, kMostFixed + kMostShare * job});
    return true;
  }

 private:
  void in_process() {
    const auto result = run_pipeline(mesh_, Format::glb, {}, {}, {});
    if (!result || result->bytes.size() == 0) failed_ = true;
  }

  void by_worker(WorkerPool& pool) {
    const auto output = open_file(folder_.path() / "output", O_RDWR | O_CREAT | O_TRUNC);
    const WorkerWatch watch{[](const Progress&) {}, [](std::string_view) {}, [] { return true; },
                            flag_};
    const auto end = run_worker(pool, {input_.get(), output->get(), {}, {}}, watch);
    if (!end || !std::holds_alternative<Finished>(*end)) failed_ = true;
  }

  const test::TemporaryDirectory folder_;
  const std::vector<std::byte> mesh_;
  const int rounds_;
  Figures& figures_;
  const UniqueFd input_;
  const EventFlag flag_;
  const Log log_{STDERR_FILENO};
  WorkerPool pool_{FAIRWAY_TOOL, WorkerLimits{}, 1, log_};
  WorkerPool cold_pool_{FAIRWAY_TOOL, WorkerLimits{}, 0, log_};
  bool failed_ = false;
};

/// Pages that a waiting worker has for itself, and all that it has resident, MiB.
void measure_waiting(Figures& figures) {
  const Log log(STDERR_FILENO);
  WorkerPool pool(FAIRWAY_TOOL, WorkerLimits{}, 0, log);
  const auto worker = pool.take();
  if (!worker) return;
  let_it_get_ready();
  double resident = 0.0;
  double own = 0.0;
  const std::string path = fmt::format("/proc/{}/smaps_rollup", worker->process.pid());
  if (std::FILE* file = std::fopen(path.c_str(), "r")) {
    std::array<char, 200> line;
    while (std::fgets(line.data(), line.size(), file) != nullptr) {
      double kibi = 0.0;
      if (std::sscanf(line.data(), "Rss: %lf", &kibi) == 1) resident = kibi / 1024.0;
      if (std::sscanf(line.data(), "Private_%*[^:]: %lf", &kibi) == 1) own += kibi / 1024.0;
    }
    std::fclose(file);
  }
  figures.line("a waiting worker: resident", resident, "MiB");
  figures.line("a waiting worker: not shared with others", own, "MiB");
}

bool run(const Options& options) {
  Figures figures(options.json);
  for (const std::size_t size : options.sizes) {
    IsolationBench bench(size, options.rounds, figures);
    if (!bench.run(fmt::format("{} vertices", size))) return false;
  }
  measure_waiting(figures);
  figures.summary();
  return true;
}

}  // namespace
}  // namespace fairway::bench

int main(int argc, char** argv) {
  fairway::bench::Options options;
  CLI::App app("Benchmark of the isolation of jobs", "isolation_bench");
  app.add_flag("--json", options.json, "One JSON line per figure");
  app.add_option("--rounds", options.rounds, "Rounds")->check(CLI::Range(5, 10'000));
  app.add_option("--sizes", options.sizes, "Numbers of vertices")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGPIPE, SIG_IGN);
  fairway::prepare_heap(std::size_t{64} << 20U);  // as a worker does
  if (fairway::bench::run(options)) return 0;
  fmt::print(stderr, "isolation_bench: a job failed\n");
  return 1;
}
