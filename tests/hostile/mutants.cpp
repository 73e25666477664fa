// Mutated meshes through real worker processes.
#include "tests/hostile/mutants.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "proto/messages/problem.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/fairwayd/work/worker_pool.h"
#include "server/fairwayd/work/worker_run.h"
#include "server/os/file.h"
#include "tests/fuzz/mutations.h"
#include "tests/fuzz/seeds.h"
#include "tests/places.h"

namespace fairway::hostile {
namespace {

constexpr std::size_t kBatch = 500;
constexpr std::size_t kFailuresShown = 5;

/// Formats by the fuzz targets that have their seeds.
struct Kind {
  const char* name;
  Format format;
};
constexpr std::array kKinds = {Kind{"glb", Format::glb},       Kind{"gltf", Format::gltf},
                               Kind{"draco_glb", Format::glb}, Kind{"meshopt_glb", Format::glb},
                               Kind{"drc", Format::drc},       Kind{"ply", Format::ply},
                               Kind{"obj", Format::obj},       Kind{"stl", Format::stl}};

/// Small meshes are done in milliseconds; what takes longer spins.
WorkerLimits limits() {
  WorkerLimits limits;
  limits.address_space = std::uint64_t{2} << 30;
#ifdef FAIRWAY_SANITIZED
  limits.address_space = 0;
#endif
  limits.cpu = std::chrono::seconds(5);
  limits.deadline = std::chrono::seconds(600);  // of this machine, which may stand still
  return limits;
}

struct Counts {
  std::map<std::string, std::size_t> outcomes;  ///< "done", or the problem's code
  std::vector<std::string> failures;
};

UniqueFd memory_file(ByteSpan bytes) {
  UniqueFd file(::memfd_create("mutant", MFD_CLOEXEC));
  expect(static_cast<bool>(file), "no memory file can be made");
  expect(static_cast<bool>(write_all(file.get(), bytes)), "a memory file cannot be written");
  ::lseek(file.get(), 0, SEEK_SET);
  return file;
}

/// "done", the code of a problem, or " " and what broke the promise.
std::string outcome_of(const WorkerEnd& end) {
  if (std::holds_alternative<Finished>(end)) return "done";
  if (const auto* failed = std::get_if<Failed>(&end)) {
    const ProblemKind& kind = problem_kind(failed->error.code);
    // time_limit and memory_limit are of the class 4xx, too: the mesh asks for too much.
    if (kind.status < 400 || kind.status >= 500) return fmt::format(" answered {}", kind.slug);
    return std::string(kind.slug);
  }
  if (const auto* died = std::get_if<WorkerDied>(&end)) {
    if (died->cause.code == ErrorCode::memory_limit) return "memory_limit";
    return " " + died->how;
  }
  return " was stopped";
}

std::string run_one(WorkerPool& workers, ByteSpan bytes, Format format, const EventFlag& never) {
  const UniqueFd input = memory_file(bytes);
  const UniqueFd output = memory_file({});
  WorkerOrder order;
  order.input = format;
  order.parameters = *parse_parameters(R"({"steps":2})");
  const WorkerTask task{input.get(), output.get(), order, limits()};
  const WorkerWatch watch{[](const Progress&) {}, [](std::string_view) {}, [] { return true; },
                          never};
  const auto end = run_worker(workers, task, watch);
  if (!end) return " could not be started: " + end.error().message;
  return outcome_of(*end);
}

/// Where it is to be had again: --only mutations --seed S names the same mutant by this number.
struct Mutant {
  std::string name;
  std::vector<std::byte> bytes;
};

std::vector<Mutant> mutants_of(const std::vector<test::Seed>& seeds, std::size_t count,
                               std::uint64_t seed) {
  std::vector<Mutant> out;
  test::Random random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    const test::Seed& from = seeds.at(i % seeds.size());
    std::vector<std::byte> bytes = test::mutated(from.bytes, random);
    for (std::uint64_t more = random() % 3; more > 0; --more) {
      bytes = test::mutated(bytes, random);
    }
    out.push_back({fmt::format("{} #{}", from.name, i), std::move(bytes)});
  }
  return out;
}

Counts run_batch(WorkerPool& workers, const std::vector<Mutant>& mutants, Format format,
                 std::size_t in_flight, const EventFlag& never) {
  std::mutex mutex;
  Counts counts;
  std::atomic<std::size_t> next = 0;
  const auto serve = [&] {
    for (std::size_t i; (i = next++) < mutants.size();) {
      std::string outcome;
      try {
        outcome = run_one(workers, mutants[i].bytes, format, never);
      } catch (const Broken& broken) {
        outcome = std::string(" ") + broken.what();
      }
      const std::lock_guard lock(mutex);
      if (outcome.starts_with(' ')) {
        counts.failures.push_back(mutants[i].name + outcome);
      } else {
        ++counts.outcomes[outcome];
      }
    }
  };
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < in_flight; ++i) threads.emplace_back(serve);
  threads.clear();
  return counts;
}

std::string described(const Counts& counts) {
  std::string text;
  for (const auto& [outcome, count] : counts.outcomes) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, outcome);
  }
  return text;
}

void expect_promises(const Counts& counts) {
  std::string shown;
  for (std::size_t i = 0; i < std::min(counts.failures.size(), kFailuresShown); ++i) {
    shown += (i == 0 ? "" : "; ") + counts.failures[i];
  }
  expect(counts.failures.empty(), fmt::format("{} mutants: {}", counts.failures.size(), shown));
}

}  // namespace

void run_mutants(Score& score, const MutantOptions& options) {
  const auto never = EventFlag::create();
  expect(static_cast<bool>(never), "no event flag can be made");
  const UniqueFd null(::open("/dev/null", O_WRONLY | O_CLOEXEC));
  const Log log(null.get());
  WorkerPool workers(test::program("fairway"), limits(), options.in_flight + 1, log);
  expect(static_cast<bool>(workers.start()), "no worker can be started");
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    const Kind& kind = kKinds[k];
    score.enter(fmt::format("mutants: {}", kind.name));
    const auto seeds = test::seeds_of(kind.name);
    // Rounded so that all of them together are as many as asked for.
    const std::size_t count =
        options.count * (k + 1) / kKinds.size() - options.count * k / kKinds.size();
    Counts all;
    for (std::size_t first = 0; first < count; first += kBatch) {
      score.run(fmt::format("#{}", first / kBatch), [&] {
        const std::uint64_t seed = options.seed * 1000 + k * 100 + first / kBatch;
        const Counts counts =
            run_batch(workers, mutants_of(seeds, std::min(kBatch, count - first), seed),
                      kind.format, options.in_flight, *never);
        for (const auto& [outcome, number] : counts.outcomes) all.outcomes[outcome] += number;
        expect_promises(counts);
      });
    }
    score.note(fmt::format("{} mutants: {}", count, described(all)));
  }
}

}  // namespace fairway::hostile
