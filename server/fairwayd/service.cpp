#include "server/fairwayd/service.h"

#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/fairwayd/api/api.h"
#include "server/fairwayd/api/tus.h"
#include "server/fairwayd/operations/operations.h"
#include "server/fairwayd/operations/readiness.h"
#include "server/fairwayd/store/data_directory.h"
#include "server/fairwayd/store/directory_blob_store.h"
#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/fairwayd/store/sqlite_outbox.h"
#include "server/fairwayd/store/sqlite_tenant_store.h"
#include "server/fairwayd/store/sqlite_upload_store.h"
#include "server/fairwayd/uploads/upload.h"
#include "server/fairwayd/webhooks/webhook_sender.h"
#include "server/fairwayd/work/service_metrics.h"
#include "server/fairwayd/work/supervisor.h"
#include "server/fairwayd/work/sweeper.h"
#include "server/fairwayd/work/worker_pool.h"
#include "server/os/event_flag.h"
#include "server/os/random_id.h"
#include "server/os/stop_signals.h"

namespace fairway {
namespace {

constexpr std::string_view kOwner = "local";

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

SupervisorOptions supervisor_options(const Settings& settings) {
  SupervisorOptions options;
  options.slots = settings.workers;
  options.owner = kOwner;
  options.lease = settings.lease;
  options.heartbeat = options.lease / 3;
  options.limits.address_space = settings.worker_memory;
  options.limits.deadline = settings.deadline;
  options.limits.cpu = processor_time_within(settings.deadline);
  return options;
}

WebhookSenderOptions sender_options(const Settings& settings) {
  WebhookSenderOptions options;
  options.owner = kOwner;
  options.version = FAIRWAY_VERSION;
  options.client.allow_private = settings.webhook_allow_private;
  options.first_retry = settings.webhook_retry;
  std::uint64_t seed = 0;
  fill_randomly(std::as_writable_bytes(std::span(&seed, 1)));
  options.seed = seed;
  return options;
}

ApiOptions api_options(const Settings& settings) {
  ApiOptions options;
  options.max_mesh_bytes = settings.max_body;
  options.queue_limit = settings.queue;
  options.min_free_bytes = settings.min_free;
  options.keep = settings.keep;
  options.worker_memory = settings.worker_memory;
  options.rate = settings.rate;
  options.tenant_bytes = settings.quota;
  return options;
}

ResumableUploads::Options upload_options(const Settings& settings) {
  ResumableUploads::Options options;
  options.max_bytes = settings.max_body;
  options.min_free = settings.min_free;
  options.keep = settings.upload_keep;
  options.limits.tenant_bytes = settings.quota;
  return options;
}

ConnectionLimits connection_limits(const Settings& settings) {
  ConnectionLimits limits;
  limits.body_bytes = settings.max_body + kUploadOverhead;
  return limits;
}

struct Listeners {
  Listener main;
  std::optional<Listener> admin;
};

Result<Listeners> listen(const Settings& settings) {
  auto main = listen_on(settings.listen);
  if (!main) return main.error();
  Listeners listeners{*std::move(main), {}};
  if (settings.admin_listen) {
    auto admin = listen_on(*settings.admin_listen);
    if (!admin) return admin.error();
    listeners.admin = *std::move(admin);
  }
  return listeners;
}

/// What is said on standard output once the service is ready.
std::string ready_text(const Listeners& listeners) {
  std::string text =
      fmt::format("fairwayd: listening on http://{}\n", to_string(listeners.main.address));
  if (listeners.admin) {
    text +=
        fmt::format("fairwayd: administration on http://{}\n", to_string(listeners.admin->address));
  }
  return text;
}

/// What is taken before anything runs.
struct Ground {
  DataDirectory directory;
  Listeners listeners;
  std::unique_ptr<JobStore> jobs;
  std::unique_ptr<BlobStore> blobs;
  std::unique_ptr<UploadStore> upload_rows;
  std::unique_ptr<ResumableUploads> uploads;
  std::unique_ptr<Outbox> outbox;
  std::unique_ptr<TenantStore> tenants;  ///< null where no keys are asked for
};

/// Uploads, and what is left of those of a dead server.
Result<void> prepare_uploads(Ground& ground, const Settings& settings, const Log& log) {
  auto rows = SqliteUploadStore::open(ground.directory.jobs());
  if (!rows) return rows.error();
  ground.upload_rows = *std::move(rows);
  auto uploads = ResumableUploads::open(*ground.upload_rows, *ground.blobs,
                                        ground.directory.uploads(), upload_options(settings));
  if (!uploads) return uploads.error();
  ground.uploads = *std::move(uploads);
  const auto dropped = ground.uploads->recover();
  if (!dropped) return dropped.error();
  log.write(LogLevel::info, "uploads_recovered", {{"dropped", *dropped}});
  return {};
}

/// Without keys the service is for this machine alone, unless somebody says otherwise.
Result<void> check_protection(const Settings& settings, const Listeners& listeners) {
  const bool is_local =
      listeners.main.is_loopback && (!listeners.admin || listeners.admin->is_loopback);
  if (settings.auth != AuthMode::automatic || is_local) return {};
  return Error{
      ErrorCode::usage,
      "fairwayd would listen beyond this machine, where anybody could use it. Ask for keys "
      "with --auth keys (fairwayd keys add makes one), or say --auth none where something "
      "in front of it protects it."};
}

Result<Ground> prepare(const Settings& settings, const Log& log) {
  auto directory = DataDirectory::open(settings.data);
  if (!directory) return directory.error();
  auto listeners = listen(settings);
  if (!listeners) return listeners.error();
  if (auto safe = check_protection(settings, *listeners); !safe) return safe.error();
  auto jobs = SqliteJobStore::open(directory->jobs());
  if (!jobs) return jobs.error();
  auto blobs = DirectoryBlobStore::open(directory->blobs(), directory->spool());
  if (!blobs) return blobs.error();
  if (auto done = recover(**jobs, **blobs, log); !done) return done.error();
  auto outbox = SqliteOutbox::open(directory->jobs());
  if (!outbox) return outbox.error();
  Ground ground{*std::move(directory),
                *std::move(listeners),
                *std::move(jobs),
                *std::move(blobs),
                nullptr,
                nullptr,
                *std::move(outbox),
                nullptr};
  if (auto done = prepare_uploads(ground, settings, log); !done) return done.error();
  if (settings.auth == AuthMode::keys) {
    auto tenants = SqliteTenantStore::open(ground.directory.jobs());
    if (!tenants) return tenants.error();
    ground.tenants = *std::move(tenants);
  }
  return ground;
}

/// What a running service is made of, in the order of its making.
struct Service {
  JobStore& jobs;
  BlobStore& blobs;
  Outbox& outbox;
  Readiness& readiness;
  const Gate& gate;
  ServiceMetrics& metrics;
  Api& api;
  WorkerPool& workers;
  Supervisor& supervisor;
  WebhookSender& sender;
  const EventFlag& stopping;  ///< ends connections
  const EventFlag& idle;      ///< raised where a drain has nothing left to wait for
  const Log& log;
};

/// Lets running jobs end, for a while: a second signal, or the end of the time, ends the wait.
void drain(Supervisor& supervisor, const EventFlag& idle, const StopSignals& signals,
           std::chrono::seconds time) {
  if (time.count() == 0) return;
  supervisor.drain(idle);
  signals.wait(idle.descriptor(), time);
}

/// One listener or two, until a signal comes; then no new connection or request.
Result<void> serve(const Settings& settings, Service& service, Listeners listeners,
                   const StopSignals& signals, std::stop_source& stop) {
  const CrossOrigin cross_origin(settings.cors_origins);
  const Operations::Parts parts{
      service.api,  service.jobs, service.blobs,   service.outbox, service.readiness,
      service.gate, cross_origin, service.metrics, service.log,    tus_options(settings.max_body)};
  const ConnectionLimits limits = connection_limits(settings);
  Operations main(parts, listeners.admin ? Entrance::main : Entrance::only);
  Operations administration(parts, Entrance::admin);
  const std::string ready = ready_text(listeners);
  HttpServer server(std::move(listeners.main), main, service.log, limits, service.stopping);
  std::optional<HttpServer> admin_server;
  if (listeners.admin) {
    admin_server.emplace(*std::move(listeners.admin), administration, service.log, limits,
                         service.stopping);
  }
  if (auto done = service.workers.start(); !done) return done;
  if (auto done = service.supervisor.start(); !done) return done;
  const std::jthread first_look([&service] { service.readiness.look_ahead(); });
  if (auto done = service.sender.start(); !done) return done;
  server.start();
  if (admin_server) admin_server->start();
  fmt::print("{}", ready);
  std::fflush(stdout);
  signals.wait();
  service.log.write(LogLevel::info, "stopping");
  service.stopping.raise();
  service.workers.close();
  drain(service.supervisor, service.idle, signals, settings.drain);
  stop.request_stop();
  return {};
}

/// Shells give 1024 at first; clients alone may hold more.
void allow_all_descriptors() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace

Result<void> run_service(const Settings& settings) {
  auto signals = StopSignals::block();
  if (!signals) return signals.error();
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of file sizes is a full storage, not an end
  allow_all_descriptors();
  ::umask(077);  // meshes are their owners' business, and no other user's of this machine
  const Log log(STDERR_FILENO);
  for (const std::string& name : settings.unknown_variables) {
    log.write(LogLevel::warning, "unknown_variable", {{"name", name}});
  }
  auto worker = worker_program(settings);
  if (!worker) return worker.error();
  auto ground = prepare(settings, log);
  if (!ground) return ground.error();
  auto stopping = EventFlag::create();
  auto idle = EventFlag::create();
  if (!stopping || !idle) return stopping ? idle.error() : stopping.error();

  std::stop_source stop;
  JobBoard board;
  ServiceMetrics metrics(FAIRWAY_VERSION);
  const SupervisorOptions options = supervisor_options(settings);
  WorkerPool workers(*worker, options.limits, options.slots, log);
  Supervisor supervisor(*ground->jobs, *ground->blobs, board, workers, metrics, log, options);
  const Gate gate(ground->tenants.get());
  Api api(*ground->jobs, *ground->blobs, *ground->uploads, *ground->outbox, board, supervisor,
          metrics, gate, log, api_options(settings), stop.get_token());
  Readiness readiness(*ground->jobs, *ground->blobs, workers, log,
                      {*worker, options.limits, settings.min_free}, stop.get_token());
  const Sweeper sweeper(*ground->jobs, *ground->blobs, *ground->uploads, board, log,
                        {.forget = settings.forget});
  WebhookSender sender(*ground->outbox, board, metrics, log, sender_options(settings));
  Service service{*ground->jobs, *ground->blobs, *ground->outbox, readiness, gate,  metrics, api,
                  workers,       supervisor,     sender,          *stopping, *idle, log};
  auto served = serve(settings, service, std::move(ground->listeners), *signals, stop);
  supervisor.stop();
  sender.stop();
  if (served) log.write(LogLevel::info, "stopped");
  return served;
}

}  // namespace fairway
