// The threads of a batch: each takes one file after the other all its way.

#include "server/fairway-submit/batch.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "server/fairway-submit/file_task.h"
#include "server/os/event_flag.h"
#include "server/os/stop_signals.h"

namespace fairway {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr milliseconds kRedraw{150};
/// How often requests under way are broken off while a batch ends: one may just have begun.
constexpr milliseconds kInterruptAgain{50};

ProgressDisplay::Style style_of(const SubmitOptions& options) {
  if (options.quiet) return ProgressDisplay::Style::quiet;
  return ::isatty(STDERR_FILENO) != 0 ? ProgressDisplay::Style::terminal
                                      : ProgressDisplay::Style::lines;
}

/// A running batch.
class Batch {
 public:
  Batch(const BatchContext& context, BatchReport& report, StopSignals& signals,
        const EventFlag& done)
      : context_(context),
        report_(report),
        signals_(signals),
        done_(done),
        progress_(style_of(context.options), report.files.size()),
        settings_{{context.options.server, context.options.api_key, context.options.ca_certificate},
                  context.options.retry_for,
                  context.options.labels} {}

  void run() {
    const std::size_t count = std::min(context_.options.concurrency, report_.files.size());
    for (std::size_t i = 0; i < count; ++i) {
      clients_.push_back(
          std::make_unique<ServerClient>(settings_, progress_, stop_.get_token(), i + 1));
    }
    working_ = count;
    std::vector<std::jthread> threads;
    threads.reserve(count);
    for (const auto& client : clients_) {
      threads.emplace_back([this, &client] { work(*client); });
    }
    watch();
    threads.clear();
    progress_.clear();
  }

  bool lost_server() const { return lost_server_; }
  bool was_interrupted() const { return interrupted_; }

 private:
  void work(ServerClient& client) {
    for (std::size_t i = 0; (i = next_++) < report_.files.size() && !stop_.stop_requested();) {
      const BatchFile& file = report_.files[i];
      progress_.begun();
      FileTask task(context_, file, client);
      report_.outcomes[i] = task.run();
      progress_.ended(file.input.string(), report_.outcomes[i]);
      if (task.lost_server()) {
        lost_server_ = true;
        stop_.request_stop();
      }
    }
    if (--working_ == 0) done_.raise();
  }

  /// Until all threads are done: draws, and breaks off what goes on after a stop.
  void watch() {
    for (;;) {
      const bool stopping = stop_.stop_requested();
      const auto woken = signals_.wait(done_.descriptor(), stopping ? kInterruptAgain : kRedraw);
      if (woken == StopSignals::Woken::flag) return;
      if (woken == StopSignals::Woken::signal) {
        // All that matters is on the disk already.
        if (interrupted_) ::_exit(static_cast<int>(SubmitExit::interrupted));
        interrupted_ = true;
        stop_.request_stop();
      }
      if (stop_.stop_requested()) {
        for (const auto& client : clients_) client->interrupt();
      } else {
        progress_.draw();
      }
    }
  }

  const BatchContext& context_;
  BatchReport& report_;  ///< each thread writes the outcomes of its own files
  StopSignals& signals_;
  const EventFlag& done_;
  ProgressDisplay progress_;
  const ClientSettings settings_;
  std::vector<std::unique_ptr<ServerClient>> clients_;
  std::stop_source stop_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<std::size_t> working_ = 0;
  std::atomic<bool> lost_server_ = false;
  bool interrupted_ = false;
};

SubmitExit exit_of(const Batch& batch, const BatchReport& report) {
  const bool all =
      std::all_of(report.outcomes.begin(), report.outcomes.end(), [](const FileOutcome& outcome) {
        return outcome.state == FileState::succeeded || outcome.state == FileState::kept;
      });
  if (all) return SubmitExit::all;
  if (batch.was_interrupted()) return SubmitExit::interrupted;
  return batch.lost_server() ? SubmitExit::no_server : SubmitExit::some_failed;
}

}  // namespace

Result<BatchReport> run_batch(const SubmitOptions& options) {
  const auto begin = Clock::now();
  // First of all, so that every thread that follows leaves the signals to us.
  auto signals = StopSignals::block();
  if (!signals) return signals.error();
  const auto done = EventFlag::create();
  if (!done) return done.error();
  auto files = plan_batch(options);
  if (!files) return files.error();
  auto out = OutDirectory::open(options.out);
  if (!out) return out.error();
  auto journal = Journal::open(out->journal());
  if (!journal) return journal.error();

  BatchReport report;
  report.batch = journal->batch();
  report.outcomes.resize(files->size());
  report.files = *std::move(files);
  const BatchContext context{options, *out, *journal};
  Batch batch(context, report, *signals, *done);
  batch.run();
  report.exit = exit_of(batch, report);
  report.took = std::chrono::duration_cast<milliseconds>(Clock::now() - begin);
  return report;
}

}  // namespace fairway
