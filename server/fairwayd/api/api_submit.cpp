// From an upload to a queued job, and the synchronous way to its result.

#include <algorithm>
#include <chrono>
#include <initializer_list>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/api/api.h"
#include "server/fairwayd/api/result_format.h"
#include "server/fairwayd/http/http_prefer.h"
#include "server/fairwayd/uploads/memory_estimate.h"
#include "server/fairwayd/uploads/upload.h"
#include "server/fairwayd/work/job_log.h"
#include "server/fairwayd/work/job_wait.h"
#include "server/os/kill_point.h"
#include "server/os/random_id.h"
#include "server/os/sha256.h"

namespace fairway {
namespace {

/// Longer than any job: a wait without an end.
constexpr std::chrono::hours kForever{24 * 365};

/// An upload between its last byte and its row. It is counted, so that one for which there will be
/// no place is refused before the disk has been waited for.
class Entering {
 public:
  explicit Entering(std::atomic<std::size_t>& count) : count_(count), ahead_(count++) {}
  Entering(const Entering&) = delete;
  Entering& operator=(const Entering&) = delete;
  ~Entering() { --count_; }

  std::size_t ahead() const { return ahead_; }

 private:
  std::atomic<std::size_t>& count_;
  const std::size_t ahead_;
};

bool is_over(const Job& job) {
  return is_final(job.state);
}

/// A new job is accepted; one that is there, or has its result, is shown.
int accepted_status(const Submission& submitted) {
  return submitted.is_new && !submitted.job.cached ? 202 : 200;
}

/// "" where the request has none. Errors: bad_request.
Result<std::string> idempotency_key(const HttpRequest& request) {
  constexpr std::size_t kLongest = 255;
  const auto key = request.header("idempotency-key");
  if (!key) return std::string();
  const bool is_plain =
      std::all_of(key->begin(), key->end(), [](char c) { return c > ' ' && c < 0x7f; });
  if (key->empty() || key->size() > kLongest || !is_plain) {
    return Error{ErrorCode::bad_request,
                 "An Idempotency-Key is 1 to 255 characters of printable ASCII without spaces."};
  }
  return std::string(*key);
}

/// SHA-256 of the texts, told apart by their lengths.
std::string digest_of(std::initializer_list<std::string_view> texts) {
  Sha256 hash;
  for (const std::string_view text : texts) {
    const std::string head = fmt::format("{}:", text.size());
    hash.update(std::as_bytes(std::span(head)));
    hash.update(std::as_bytes(std::span(text)));
  }
  return hash.hex();
}

/// Whether a worker could do the job at all. `memory`: in bytes, of one; 0 = any.
Result<void> check_memory(const NewJob& job, std::uint64_t memory) {
  const std::uint64_t needed = least_memory(job.input_format, job.input.bytes);
  if (memory == 0 || needed <= memory) return {};
  return Error{ErrorCode::too_large,
               fmt::format("The mesh needs at least {} bytes of memory, a job here has {}: send it "
                           "in parts, or have --worker-memory raised.",
                           needed, memory)};
}

}  // namespace

HttpResponse Api::submit_job(const JobName& name, const HttpRequest& request, BodySource& body) {
  const auto submitted = submit(name, request, body);
  if (!submitted) return refuse_upload(submitted.error());
  return job_response(submitted->job, accepted_status(*submitted));
}

HttpResponse Api::denoise(const std::string& tenant, const HttpRequest& request, BodySource& body) {
  const auto submitted = submit({tenant, random_id()}, request, body);
  if (!submitted) return refuse_upload(submitted.error());
  const Preferences wanted = preferences_of(request);
  // Where the work is done already there is nothing to wait for: a 200 is always the mesh.
  const bool at_once = wanted.respond_async && !wanted.wait && !is_over(submitted->job);
  HttpResponse response = at_once ? job_response(submitted->job, 202)
                                  : wait_for_result(*submitted, request, wanted.wait);
  if (response.status != 202) {
    response.headers.emplace_back("Location", "/v1/jobs/" + submitted->job.id);
  }
  const std::string applied = applied_text(wanted);
  if (!applied.empty()) response.headers.emplace_back("Preference-Applied", applied);
  return response;
}

/// Jobs and inspections wait in one queue. `ahead`: those that are about to enter it.
Result<void> Api::check_queue(std::size_t ahead) {
  const auto queued = jobs_.queue_length();
  if (!queued) return queued.error();
  if (*queued + ahead + supervisor_.waiting_inspections() >= options_.queue_limit) {
    return Error{ErrorCode::queue_full, "The queue is full: try again later."};
  }
  return {};
}

/// What can be refused before the mesh is read.
Result<void> Api::check_room(const JobName& name, const HttpRequest& request) {
  if (auto place = check_queue(); !place) return place;
  return jobs_.check_room(name.tenant, request.content_length.value_or(0), limits());
}

/// Whether there may be a job of an earlier try: it is found in a full queue, too.
Result<bool> Api::came_before(const JobName& name, const HttpRequest& request,
                              const std::string& key) {
  if (key.empty() && request.method != "PUT") return false;
  return jobs_.has_submit(name, key);
}

/// The input of an earlier job; nothing has to be stored.
Result<std::optional<ResumableUpload>> Api::find_input(const std::string& sha256, NewJob& job,
                                                       Upload& upload) {
  const auto earlier = jobs_.find_input(job.name.tenant, sha256);
  if (!earlier) return earlier.error();
  job.input = earlier->input;
  upload.format = earlier->input_format;
  upload.files = earlier->input_files;
  return std::optional<ResumableUpload>();
}

/// An upload that is whole. What is left of one that has become a job is enough to tell whether
/// this submit was the one; the store refuses any other.
Result<std::optional<ResumableUpload>> Api::find_upload(const std::string& id, NewJob& job,
                                                        Upload& upload) {
  auto whole = uploads_.whole({job.name.tenant, id});
  if (!whole) return whole.error();
  job.upload = whole->name.id;
  if (whole->used) {
    job.input = {"", whole->length, whole->used->sha256};
    upload.format = whole->used->format;
    return std::optional<ResumableUpload>();
  }
  const auto format = uploads_.recognise(*whole);
  if (!format) return format.error();
  job.owns_input = true;
  upload.format = *format;
  return std::optional(*std::move(whole));
}

/// The input, durable, and what is to be done with it.
Result<NewJob> Api::take_in(const JobName& name, const HttpRequest& request, Upload upload) {
  NewJob job;
  job.name = name;
  job.owns_input = upload.mesh != nullptr;
  std::optional<ResumableUpload> whole;
  if (!job.owns_input) {
    auto query = read_upload_query(request, UploadUse::job);
    if (!query) return query.error();
    auto found = query->upload ? find_upload(*query->upload, job, upload)
                               : find_input(query->input_sha256.value_or(""), job, upload);
    if (!found) return found.error();
    whole = *std::move(found);
  }
  if (auto met = heed_accept(request, upload); !met) return met.error();
  if (job.owns_input) {
    const std::string key = "in-" + random_id();
    auto input = whole ? uploads_.give(*whole, key) : upload.mesh->commit(key);
    if (!input) return input.error();
    job.input = *std::move(input);
  }
  job.input_format = upload.format;
  job.input_files = upload.files;
  job.parameters = dump_json(parameters_document(upload.parameters));
  job.options = upload.options;
  job.keep = upload.options.ttl.value_or(std::chrono::ceil<std::chrono::seconds>(options_.keep));
  const std::string& digest = upload.digest.empty() ? job.input.sha256 : upload.digest;
  job.content = digest_of({FAIRWAY_VERSION, digest, name_of(job.input_format), job.parameters});
  const std::string_view own_id = request.method == "PUT" ? std::string_view(name.id) : "";
  job.fingerprint = digest_of({job.content, dump_json(job_options_document(job.options)), own_id});
  job.trace_id = request.trace.trace_id;
  job.may_share = request.header("cache-control").value_or("") != "no-cache";
  return job;
}

/// Its upload is not needed: the submit was refused, or there is a job with the same input.
void Api::drop_upload(const NewJob& job) {
  if (job.owns_input) remove_blob(job.input.key);
}

/// Its upload has become the job: what cannot be removed now goes at the next start.
void Api::drop_used(const NewJob& job) {
  if (auto dropped = uploads_.drop_bytes({job.name.tenant, job.upload}); !dropped) {
    log_.write(LogLevel::warning, "upload_not_removed", {{"reason", dropped.error().message}});
  }
}

/// Order is the promise of a 202: the input is durable, then the row is committed.
Result<Submission> Api::submit(const JobName& name, const HttpRequest& request, BodySource& body) {
  if (auto checked = check_upload(request, UploadUse::job, options_.max_mesh_bytes); !checked) {
    return checked.error();
  }
  auto key = idempotency_key(request);
  if (!key) return key.error();
  const auto alone = keys_in_flight_.enter(
      fmt::format("{} {} {}", name.tenant, *key, key->empty() ? name.id : ""));
  if (!alone) {
    return Error{ErrorCode::conflict,
                 "The same submit is on its way: ask again when its upload is over."};
  }
  const std::uint64_t bytes = request.content_length.value_or(0);
  if (auto room = check_disk(blobs_, options_.min_free_bytes, bytes); !room) return room.error();
  const auto is_repeated = came_before(name, request, *key);
  if (!is_repeated) return is_repeated.error();
  if (!*is_repeated) {
    if (auto room = check_room(name, request); !room) return room.error();
  }
  auto upload = receive_upload(request, UploadUse::job, body, blobs_, options_.max_mesh_bytes);
  if (!upload) return upload.error();
  std::optional<Entering> entering;
  if (!*is_repeated) {
    entering.emplace(entering_);
    if (auto place = check_queue(entering->ahead()); !place) return place.error();
  }
  auto job = take_in(name, request, *std::move(upload));
  if (!job) return job.error();
  job->idempotency_key = *std::move(key);
  if (auto fits = check_memory(*job, options_.worker_memory); !fits) {
    drop_upload(*job);
    return fits.error();
  }
  return store(*job);
}

Result<Submission> Api::store(const NewJob& job) {
  auto stored = jobs_.submit(job, limits());
  if (!stored) {
    drop_upload(job);
    return stored.error();
  }
  if (stored->job.input.key != job.input.key) drop_upload(job);
  if (!stored->is_new) return stored;
  if (!job.upload.empty()) drop_used(job);
  about(log_, stored->job)
      .write(LogLevel::info, "job_queued",
             {{"bytes", job.input.bytes}, {"cached", stored->job.cached}});
  board_.announce();
  supervisor_.wake();
  kill_point("submit.answer");
  return stored;
}

/// A client that asks for an answer in time gets the job document when that is over, and the job
/// goes on. One that hangs up while it waits for the mesh has no use for the job, unless another
/// submit made it.
HttpResponse Api::wait_for_result(const Submission& submitted, const HttpRequest& request,
                                  std::optional<std::chrono::seconds> time) {
  const auto waited =
      wait_for_job({jobs_, board_, stop_, request.client_is_there}, submitted.job.number,
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
      if (submitted.is_new) [[maybe_unused]]
        const auto canceled = cancel({submitted.job.tenant, submitted.job.id});
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
