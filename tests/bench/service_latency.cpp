// What the service adds to a run of the tool over the same work, asked both ways, and a plain
// Python service beside it. All take turns, so that they see the same weather.

#include <fcntl.h>
#include <fmt/format.h>

#include "server/os/child_process.h"
#include "server/os/file.h"
#include "tests/bench/kept_connection.h"
#include "tests/bench/report.h"
#include "tests/bench/service_bench.h"

namespace fairway::bench {
namespace {

/// Of a job over the tool: a share for the second process and the disk, and what HTTP takes.
constexpr double kMostOfTool = 1.3;
constexpr double kMostAdded = 15.0;  // milliseconds
constexpr double kLeastOverPeer = 6.0;

using Times = std::vector<double>;

/// Of each round, seconds.
struct Latencies {
  Times tool;
  Times followed;
  Times accepted;
  Times done;
  Times fetched;
  Times sync;
  Times few_steps;  ///< as sync, with as many steps as the peer has iterations
  Times peer;
  std::string timing;
};

/// `fairway denoise` of a new file, from the start of the process to its exit.
Result<double> tool_run(const std::filesystem::path& folder) {
  const auto null = open_file("/dev/null", O_RDWR);
  if (!null) return null.error();
  std::optional<Error> failed;
  const double time = seconds_of([&] {
    auto child =
        ChildProcess::spawn({.program = FAIRWAY_TOOL,
                             .arguments = {"denoise", "-q", folder / "in.glb", folder / "out.glb"},
                             .environment = {},
                             .descriptors = {null->get(), null->get(), null->get()}});
    if (!child) {
      failed = child.error();
    } else if (const ExitStatus status = child->wait(); status.code != 0 || status.signal != 0) {
      failed = Error{ErrorCode::internal, fmt::format("The tool ended with {}.", status.code)};
    }
  });
  if (failed) return *failed;
  return time;
}

Result<void> write_to(const std::filesystem::path& path, const Bytes& bytes) {
  const auto file = open_file(path, O_WRONLY | O_CREAT | O_TRUNC);
  if (!file) return file.error();
  return write_all(file->get(), bytes);
}

/// POST /v1/denoise of a new file.
Result<void> time_denoise(ServiceBench& bench, KeptConnection& connection, std::string_view query,
                          Times& times) {
  const Bytes upload = bench.uploads.next();
  if (auto done = connection.warm(); !done) return done;
  Result<Reply> answer = Reply();
  times.push_back(seconds_of([&] { answer = denoise_by(connection, upload, query); }));
  return answer ? Result<void>() : answer.error();
}

/// The tool, the service both ways and the peer, one after the other, each with a file of its own.
Result<void> round(ServiceBench& bench, KeptConnection& service, KeptConnection* peer,
                   Latencies& to) {
  if (auto done = write_to(bench.folder / "in.glb", bench.uploads.next()); !done) return done;
  const auto tool = tool_run(bench.folder);
  if (!tool) return tool.error();
  to.tool.push_back(*tool);

  const Bytes upload = bench.uploads.next();
  if (auto done = service.warm(); !done) return done;
  const auto job = follow_job(service, upload);
  if (!job) return job.error();
  to.followed.push_back(job->total());
  to.accepted.push_back(job->accepted);
  to.done.push_back(job->done);
  to.fetched.push_back(job->fetched);
  to.timing = job->timing;

  if (auto done = time_denoise(bench, service, {}, to.sync); !done) return done;
  if (peer == nullptr) return {};
  if (auto done = time_denoise(bench, *peer, {}, to.peer); !done) return done;
  // {"steps":10}
  return time_denoise(bench, service, "?params=%7B%22steps%22%3A10%7D", to.few_steps);
}

void report(const Latencies& times, Figures& figures) {
  const auto line = [&](const std::string& name, const Times& values,
                        std::optional<double> most = {}) {
    const auto limit = most ? std::optional(Limit{Limit::Kind::at_most, *most}) : std::nullopt;
    figures.line(name + ", median", 1e3 * median(values), "ms", limit);
    figures.line(name + ", least", 1e3 * least(values), "ms");
  };
  line("fairway denoise", times.tool);
  const double most = kMostOfTool * 1e3 * median(times.tool) + kMostAdded;
  line("POST /v1/jobs, follow, GET result", times.followed, most);
  figures.note(fmt::format("upload to 202 {:.1f}, to its end {:.1f}, result {:.1f} ms (medians)",
                           1e3 * median(times.accepted), 1e3 * median(times.done),
                           1e3 * median(times.fetched)));
  figures.note("the service of the last one, ms: " + times.timing);
  line("POST /v1/denoise", times.sync, most);
  if (times.peer.empty()) return;
  line("FastAPI, Open3D: Taubin 10 times", times.peer);
  line("POST /v1/denoise, 10 steps", times.few_steps);
  figures.line("FastAPI, Open3D by ours, 10 steps", median(times.peer) / median(times.few_steps),
               "");
  figures.line("FastAPI, Open3D by ours, as it comes", median(times.peer) / median(times.sync), "",
               Limit{Limit::Kind::at_least, kLeastOverPeer});
}

}  // namespace

Result<void> measure_latency(ServiceBench& bench) {
  auto service = start_service(bench, "latency");
  if (!service) return service.error();
  KeptConnection to_service(service->port());
  std::optional<MeasuredProcess> peer;
  std::optional<KeptConnection> to_peer;
  if (!bench.options.no_peer) {
    auto started =
        MeasuredProcess::start("/usr/bin/python3", {FAIRWAY_PEER}, bench.folder / "peer.log");
    if (!started) return started.error();
    peer.emplace(*std::move(started));
    to_peer.emplace(peer->port());
  }
  KeptConnection* const other = to_peer ? &*to_peer : nullptr;
  Latencies unmeasured;
  if (auto done = round(bench, to_service, other, unmeasured); !done) return done;
  Latencies times;
  for (int i = 0; i < bench.options.rounds; ++i) {
    if (auto done = round(bench, to_service, other, times); !done) return done;
  }
  report(times, bench.figures);
  return {};
}

}  // namespace fairway::bench
