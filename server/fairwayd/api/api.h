#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/fairwayd/api/contract.h"
#include "server/fairwayd/api/gate.h"
#include "server/fairwayd/api/keys_in_flight.h"
#include "server/fairwayd/api/rate_limit.h"
#include "server/fairwayd/api/routes.h"
#include "server/fairwayd/api/watch_limit.h"
#include "server/fairwayd/http/http_engine.h"
#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/store/blob_store.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/store/outbox.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/fairwayd/uploads/resumable_uploads.h"
#include "server/fairwayd/uploads/upload.h"
#include "server/fairwayd/work/inspection_task.h"
#include "server/fairwayd/work/job_board.h"
#include "server/fairwayd/work/service_metrics.h"
#include "server/fairwayd/work/supervisor.h"

namespace fairway {

struct Upload;

/// How many requests may follow jobs at once; half of the threads that answer.
inline constexpr std::size_t kMaxWatches = 256;

struct ApiOptions {
  std::uint64_t max_mesh_bytes = std::uint64_t{512} << 20;
  std::size_t queue_limit = 256;
  std::uint64_t min_free_bytes = 0;                         ///< to leave in the blob store
  std::chrono::milliseconds keep = std::chrono::hours(24);  ///< input and result after a job's end
  std::uint64_t worker_memory = 0;                          ///< bytes that a job may have; 0 = any
  std::uint64_t rate = 0;          ///< submits a minute of one tenant; 0 = any
  std::uint64_t tenant_bytes = 0;  ///< see SubmitLimits
};

/// The HTTP API over the stores. Knows no socket and no process.
class Api final : public HttpApplication {
 public:
  /// All references must outlive it; `stop` ends the waits of POST /v1/denoise
  /// and POST /v1/inspect.
  Api(JobStore& jobs, BlobStore& blobs, ResumableUploads& uploads, Outbox& outbox, JobBoard& board,
      Supervisor& supervisor, ServiceMetrics& metrics, const Gate& gate, const Log& log,
      const ApiOptions& options, std::stop_token stop);

  bool wants_body(const HttpRequest& request) const override;
  HttpResponse answer(const HttpRequest& request, BodySource& body) override;

 private:
  HttpResponse answer_place(const Route& route, const std::string& tenant,
                            const HttpRequest& request, BodySource& body);
  HttpResponse answer_job(const Route& route, const JobName& name, const HttpRequest& request,
                          BodySource& body);
  HttpResponse answer_in_limits(const Route& route, const std::string& tenant,
                                const HttpRequest& request, BodySource& body);
  HttpResponse answer_upload(const Route& route, const std::string& tenant,
                             const HttpRequest& request, BodySource& body);
  HttpResponse submit_job(const JobName& name, const HttpRequest& request, BodySource& body);
  HttpResponse denoise(const std::string& tenant, const HttpRequest& request, BodySource& body);
  HttpResponse inspect(const HttpRequest& request, BodySource& body);
  HttpResponse list_jobs(const std::string& tenant, const HttpRequest& request);
  HttpResponse show_job(const HttpRequest& request, const JobName& name);
  HttpResponse show_result(const HttpRequest& request, const JobName& name);
  HttpResponse job_events(const HttpRequest& request, const JobName& name);
  HttpResponse cancel_job(const JobName& name);
  HttpResponse retry_job(const JobName& name);
  HttpResponse delete_job(const JobName& name);
  HttpResponse list_deliveries(const JobName& name);
  HttpResponse redeliver(const JobName& name, const std::string& delivery_id);

  Result<void> check_queue(std::size_t ahead = 0);
  Result<void> check_room(const JobName& name, const HttpRequest& request);
  Result<bool> came_before(const JobName& name, const HttpRequest& request, const std::string& key);
  SubmitLimits limits() const { return {options_.queue_limit, options_.tenant_bytes}; }
  Result<std::shared_ptr<InspectionTask>> line_up(const HttpRequest& request, BodySource& body);
  Result<Submission> submit(const JobName& name, const HttpRequest& request, BodySource& body);
  Result<Submission> store(const NewJob& job);
  Result<NewJob> take_in(const JobName& name, const HttpRequest& request, Upload upload);
  Result<std::optional<ResumableUpload>> find_input(const std::string& sha256, NewJob& job,
                                                    Upload& upload);
  Result<std::optional<ResumableUpload>> find_upload(const std::string& id, NewJob& job,
                                                     Upload& upload);
  void drop_upload(const NewJob& job);
  void drop_used(const NewJob& job);
  void remove_blob(const std::string& key);
  Result<Job> cancel(const JobName& name);
  HttpResponse changed(const Job& job, const HttpRequest& request);
  HttpResponse await_change(const HttpRequest& request, const Job& known);
  HttpResponse wait_for_result(const Submission& submitted, const HttpRequest& request,
                               std::optional<std::chrono::seconds> time);
  HttpResponse result_of(const Job& job, const HttpRequest& request);
  HttpResponse refuse(const Error& error) const;
  HttpResponse refuse_upload(const Error& error) const;
  Json document_of(const Job& job);
  HttpResponse job_response(const Job& job, int status);

  JobStore& jobs_;
  BlobStore& blobs_;
  ResumableUploads& uploads_;
  Outbox& outbox_;
  JobBoard& board_;
  Supervisor& supervisor_;
  ServiceMetrics& metrics_;
  const Gate& gate_;
  const Log& log_;
  const ApiOptions options_;
  const std::stop_token stop_;
  WatchLimit watches_{kMaxWatches};
  const Contract contract_;
  std::atomic<std::size_t> entering_ = 0;  ///< uploads that are being made durable
  KeysInFlight keys_in_flight_;
  RateLimit rate_limit_;
};

}  // namespace fairway
