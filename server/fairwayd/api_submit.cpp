// From an upload to a queued job, and the synchronous way to its result.

#include <chrono>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/api.h"
#include "server/fairwayd/http_prefer.h"
#include "server/fairwayd/job_log.h"
#include "server/fairwayd/job_wait.h"
#include "server/fairwayd/result_format.h"
#include "server/fairwayd/upload.h"
#include "server/os/random_id.h"

namespace fairway {
namespace {

/// Longer than any job: a wait without an end.
constexpr std::chrono::hours kForever{24 * 365};

bool is_over(const Job& job) {
  return is_final(job.state);
}

}  // namespace

HttpResponse Api::submit_job(const HttpRequest& request, BodySource& body) {
  const auto job = submit(request, body);
  return job ? job_response(*job, 202) : refuse_upload(job.error());
}

HttpResponse Api::denoise(const HttpRequest& request, BodySource& body) {
  const auto job = submit(request, body);
  if (!job) return refuse_upload(job.error());
  const Preferences wanted = preferences_of(request);
  const bool at_once = wanted.respond_async && !wanted.wait;
  HttpResponse response =
      at_once ? job_response(*job, 202) : wait_for_result(*job, request, wanted.wait);
  if (response.status != 202) response.headers.emplace_back("Location", "/v1/jobs/" + job->id);
  const std::string applied = applied_text(wanted);
  if (!applied.empty()) response.headers.emplace_back("Preference-Applied", applied);
  return response;
}

/// Whether an upload has a place to be stored in, and one in the queue.
Result<void> Api::check_room(const HttpRequest& request) {
  const auto left = blobs_.free_bytes();
  if (!left) return left.error();
  const std::uint64_t needed = request.content_length.value_or(0);
  if (*left < options_.min_free_bytes || *left - options_.min_free_bytes < needed) {
    return Error{ErrorCode::storage_full,
                 fmt::format("{} bytes are left, {} are to be.", *left, options_.min_free_bytes)};
  }
  return check_queue();
}

/// Jobs and inspections wait in one queue.
Result<void> Api::check_queue() {
  const auto queued = jobs_.queue_length();
  if (!queued) return queued.error();
  if (*queued + supervisor_.waiting_inspections() >= options_.queue_limit) {
    return Error{ErrorCode::queue_full, "The queue is full: try again later."};
  }
  return {};
}

/// Order is the promise of a 202: the input is durable, then the row is committed.
Result<Job> Api::submit(const HttpRequest& request, BodySource& body) {
  if (auto checked = check_upload(request, options_.max_mesh_bytes); !checked) {
    return checked.error();
  }
  if (auto room = check_room(request); !room) return room.error();
  auto upload = receive_upload(request, body, blobs_, options_.max_mesh_bytes);
  if (!upload) return upload.error();
  if (auto met = heed_accept(request, *upload); !met) return met.error();
  const std::string id = random_id();
  auto input = upload->mesh->commit("in-" + id);
  if (!input) return input.error();
  const NewJob job{id,
                   *input,
                   upload->format,
                   dump_json(parameters_document(upload->parameters)),
                   upload->files,
                   request.trace.trace_id};
  auto stored = jobs_.submit(job, options_.queue_limit);
  if (!stored) {
    [[maybe_unused]] const auto removed = blobs_.remove(input->key);  // else swept at the start
    return stored.error();
  }
  about(log_, *stored).write(LogLevel::info, "job_queued", {{"bytes", input->bytes}});
  board_.announce();
  supervisor_.wake();
  return stored;
}

/// A client that asks for an answer in time gets the job document when that is over, and the job
/// goes on. One that hangs up while it waits for the mesh has no use for the job.
HttpResponse Api::wait_for_result(const Job& submitted, const HttpRequest& request,
                                  std::optional<std::chrono::seconds> time) {
  const auto waited =
      wait_for_job({jobs_, board_, stop_, request.client_is_there}, submitted.id,
                   std::chrono::steady_clock::now() + time.value_or(kForever), is_over);
  if (!waited) return refuse(waited.error());
  switch (waited->end) {
    case WaitEnd::reached:
      return result_of(waited->job, request);
    case WaitEnd::time_up:
      break;
    case WaitEnd::client_gone: {
      // Where the cancel cannot be written the job runs to its end, as one without a waiting
      // client.
      [[maybe_unused]] const auto canceled = cancel(submitted.id);
      HttpResponse response = problem_response({ErrorCode::canceled, "The client hung up."});
      response.close = true;
      return response;
    }
    case WaitEnd::stopping:
      return problem_response(
          {ErrorCode::unavailable, "The server is stopping; the job goes on when it is back."});
  }
  return job_response(waited->job, 202);
}

}  // namespace fairway
