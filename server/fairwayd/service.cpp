#include "server/fairwayd/service.h"

#include <csignal>
#include <cstdio>
#include <stop_token>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/fairwayd/api.h"
#include "server/fairwayd/data_directory.h"
#include "server/fairwayd/directory_blob_store.h"
#include "server/fairwayd/sqlite_job_store.h"
#include "server/fairwayd/supervisor.h"
#include "server/fairwayd/upload.h"
#include "server/os/event_flag.h"

namespace fairway {
namespace {

constexpr std::string_view kOwner = "local";

/// Blocks the signals that stop the service, for this thread and all that it starts.
sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  return signals;
}

Result<std::filesystem::path> worker_program(const Settings& settings) {
  std::filesystem::path program = settings.worker;
  std::error_code error;
  if (program.empty()) {
    program = std::filesystem::read_symlink("/proc/self/exe", error).replace_filename("fairway");
  }
  if (error || ::access(program.c_str(), X_OK) != 0) {
    return Error{ErrorCode::io, fmt::format("The worker program {} cannot be executed: name the "
                                            "fairway program with --worker.",
                                            program.string())};
  }
  return program;
}

/// Brings what a dead server left behind into order.
Result<void> recover(JobStore& jobs, BlobStore& blobs, const Log& log) {
  auto requeued = jobs.requeue_lost(kOwner);
  if (!requeued) return requeued.error();
  auto needed = jobs.needed_blobs();
  if (!needed) return needed.error();
  auto swept = blobs.sweep(*needed);
  if (!swept) return swept.error();
  log.write(LogLevel::info, "recovered", {{"requeued", *requeued}, {"swept", *swept}});
  return {};
}

SupervisorOptions supervisor_options(const Settings& settings, std::filesystem::path worker) {
  SupervisorOptions options;
  options.slots = settings.workers;
  options.worker = std::move(worker);
  options.owner = kOwner;
  options.limits.address_space = settings.worker_memory;
  options.limits.deadline = settings.deadline;
  // A backstop: the deadline ends a job first unless it keeps every processor busy.
  options.limits.cpu = settings.deadline * std::max(1U, std::thread::hardware_concurrency());
  return options;
}

ConnectionLimits connection_limits(const Settings& settings) {
  ConnectionLimits limits;
  limits.body_bytes = settings.max_body + kUploadOverhead;
  return limits;
}

void wait_for(const sigset_t& signals) {
  int signal = 0;
  ::sigwait(&signals, &signal);
}

}  // namespace

Result<void> run_service(const Settings& settings) {
  const sigset_t signals = block_stop_signals();
  ::umask(077);  // meshes are their owners' business, and no other user's of this machine
  const Log log(STDERR_FILENO);
  auto worker = worker_program(settings);
  if (!worker) return worker.error();
  auto directory = DataDirectory::open(settings.data);
  if (!directory) return directory.error();
  auto listener = listen_on(settings.listen);
  if (!listener) return listener.error();
  auto jobs = SqliteJobStore::open(directory->jobs());
  if (!jobs) return jobs.error();
  auto blobs = DirectoryBlobStore::open(directory->blobs(), directory->spool());
  if (!blobs) return blobs.error();
  if (auto done = recover(**jobs, **blobs, log); !done) return done;
  auto stopping = EventFlag::create();
  if (!stopping) return stopping.error();

  const std::string address = to_string(listener->address);
  std::stop_source stop;
  JobBoard board;
  Supervisor supervisor(**jobs, **blobs, board, log, supervisor_options(settings, *worker));
  Api api(**jobs, **blobs, board, supervisor, log, {settings.max_body, settings.queue},
          stop.get_token());
  {
    HttpServer server(std::move(*listener), api, log, connection_limits(settings), *stopping);
    if (auto done = supervisor.start(); !done) return done;
    server.start();
    fmt::print("fairwayd: listening on http://{}\n", address);
    std::fflush(stdout);
    wait_for(signals);
    log.write(LogLevel::info, "stopping");
    stop.request_stop();
    stopping->raise();
  }
  supervisor.stop();
  log.write(LogLevel::info, "stopped");
  return {};
}

}  // namespace fairway
