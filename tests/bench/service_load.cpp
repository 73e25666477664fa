#include "tests/bench/service_load.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "tests/bench/report.h"

namespace fairway::bench {
namespace {

using Send = std::function<Result<void>(KeptConnection& connection, std::size_t job)>;

/// Does `send` for every job, by several clients; the first error ends all.
Result<void> by_clients(const MeasuredProcess& server, std::size_t jobs, std::size_t clients,
                        const Send& send) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::optional<Error> failed;
  const auto work = [&] {
    KeptConnection connection(server.port());
    for (std::size_t job; (job = next++) < jobs;) {
      auto sent = connection.warm();
      if (sent) sent = send(connection, job);
      if (sent) continue;
      const std::lock_guard lock(mutex);
      failed = sent.error();
      next = jobs;
    }
  };
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < clients; ++i) threads.emplace_back(work);
  }
  if (failed) return *failed;
  return {};
}

}  // namespace

Result<LoadRun> run_load(const MeasuredProcess& server, const std::vector<Bytes>& uploads,
                         std::size_t clients) {
  LoadRun run;
  run.jobs = uploads.size();
  std::vector<Reply> answers(uploads.size());
  const ProcessorTime before = server.processor_time();
  Result<void> done;
  run.seconds = seconds_of([&] {
    done = by_clients(server, run.jobs, clients,
                      [&](KeptConnection& connection, std::size_t job) -> Result<void> {
                        auto answer = denoise_by(connection, uploads[job]);
                        if (!answer) return answer.error();
                        answers[job].headers = std::move(answer->headers);
                        return {};
                      });
  });
  run.used = server.processor_time() - before;
  if (!done) return done.error();
  done = by_clients(server, run.jobs, 1, [&](KeptConnection& connection, std::size_t job) {
    return forget_job(connection, answers[job]);
  });
  if (!done) return done.error();
  return run;
}

Result<void> run_jobs(const MeasuredProcess& server, Uploads& uploads, std::size_t jobs,
                      std::size_t clients) {
  return by_clients(server, jobs, clients,
                    [&](KeptConnection& connection, std::size_t) -> Result<void> {
                      const auto answer = denoise_by(connection, uploads.next());
                      if (!answer) return answer.error();
                      return forget_job(connection, *answer);
                    });
}

}  // namespace fairway::bench
