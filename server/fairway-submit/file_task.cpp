// One file of a batch, from its upload to its result.

#include "server/fairway-submit/file_task.h"

#include <span>
#include <utility>

#include <fmt/format.h>

#include "proto/messages/job_document.h"
#include "proto/messages/problem.h"
#include "server/fairway-submit/json_fields.h"
#include "server/fairway-submit/problem_answer.h"
#include "server/fairway-submit/repr_digest.h"

namespace fairway {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

/// Jobs that vanish while they are followed are begun anew so often in one run.
constexpr int kMostRounds = 5;

bool is_gone(int status) {
  return status == 404 || status == 410;
}

/// What is wrong with the file or the parameters stays wrong; a missing API key does not.
bool is_final_refusal(const HttpAnswer& answer) {
  const auto problem = parse_json(answer.body);
  if (!problem) return false;
  switch (error_code_of_slug(text_in(*problem, "code"))) {
    case ErrorCode::malformed_input:
    case ErrorCode::unsupported_format:
    case ErrorCode::unsupported_feature:
    case ErrorCode::invalid_mesh:
    case ErrorCode::no_triangles:
    case ErrorCode::malformed_parameters:
    case ErrorCode::invalid_parameters:
    case ErrorCode::too_large:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::string idempotency_key(const std::string& batch, const std::string& name,
                            const JournalEntry& entry, const SubmitOptions& options) {
  std::string identity = fmt::format("{}\n{}\n{}\n{}", batch, name, entry.payload, entry.attempt);
  for (const std::string& label : options.labels) identity += '\n' + label;
  Sha256 digest;
  digest.update(std::as_bytes(std::span(identity)));
  return "fairway-submit-" + digest.hex();
}

FileTask::FileTask(const BatchContext& context, const BatchFile& file, ServerClient& client)
    : context_(context), file_(file), client_(client) {}

FileOutcome FileTask::run() {
  const auto begin = Clock::now();
  if (const auto payload = Payload::open(file_.input, context_.options.parameters)) {
    entry_ = context_.journal.entry(file_.name, payload->digest());
    Next next = take_known();
    for (int round = 0; next == Next::step && round < kMostRounds; ++round) {
      next = attempt(*payload);
      if (next == Next::start_over) next = begin_attempt();
    }
    if (next == Next::step) {
      fail(Error{ErrorCode::not_found, "The server forgets its jobs before they are done."});
    }
  } else {
    fail(payload.error());
  }
  outcome_.took = std::chrono::duration_cast<milliseconds>(Clock::now() - begin);
  return std::move(outcome_);
}

FileTask::Next FileTask::attempt(const Payload& payload) {
  Next next = entry_.job.empty() ? submit(payload) : Next::step;
  outcome_.job = entry_.job;
  if (next == Next::step) next = follow();
  if (next == Next::step) next = fetch();
  return next;
}

/// What an earlier run has left: a result, a failure, or a job to go on with.
FileTask::Next FileTask::take_known() {
  if (entry_.result && context_.out.holds(file_.name, entry_.result->sha256)) {
    outcome_.state = FileState::kept;
    outcome_.job = entry_.job;
    outcome_.sha256 = entry_.result->sha256;
    outcome_.result_bytes = entry_.result->bytes;
    return Next::over;
  }
  entry_.result.reset();
  if (context_.out.has(file_.name) && !context_.journal.wrote(file_.name)) {
    return fail(Error{ErrorCode::conflict,
                      fmt::format("{} is there and is no result of this batch: move it away, or "
                                  "choose another --out.",
                                  context_.out.result(file_.name).string())});
  }
  const bool known = !entry_.job.empty() || entry_.problem;
  const bool elsewhere = known && entry_.server != to_string(context_.options.server);
  if (entry_.problem && !elsewhere && !context_.options.retry_failed) {
    outcome_.job = entry_.job;
    return fail(*std::exchange(entry_.problem, {}), false);
  }
  return entry_.problem || elsewhere ? begin_attempt() : Next::step;
}

FileTask::Next FileTask::submit(const Payload& payload) {
  const std::string key =
      idempotency_key(context_.journal.batch(), file_.name, entry_, context_.options);
  const Exchange exchange = client_.submit(payload, key);
  if (exchange.ending != Ending::answered) return give_up(exchange);
  const HttpAnswer& answer = exchange.answer;
  if (answer.status == 200 || answer.status == 201 || answer.status == 202) {
    return accept(payload, answer);
  }
  return refuse(answer, is_final_refusal(answer));
}

/// The job is written down before anything relies on it.
FileTask::Next FileTask::accept(const Payload& payload, const HttpAnswer& answer) {
  const auto job = parse_json(answer.body);
  const std::string id = job ? text_in(*job, "id") : "";
  if (id.empty()) return refuse(answer, false);
  outcome_.sent_bytes = payload.size();
  const std::string came = job->contains("input") ? text_in((*job)["input"], "sha256") : "";
  if (!payload.input_sha256().empty() && !came.empty() && came != payload.input_sha256()) {
    // The key must not lead to this job again.
    entry_.attempt += 1;
    return write_down(fail(Error{ErrorCode::io,
                                 "The file changed while it was sent: submit it again when it is "
                                 "complete."}));
  }
  entry_.server = to_string(context_.options.server);
  entry_.job = id;
  // A job that is at its end already (its key was used before, or its work was done before) does
  // not change: nothing is to be waited for.
  const auto state = job_state_of_name(text_in(*job, "state"));
  etag_ = state && is_final(*state) ? "" : answer.header("etag");
  return write_down(Next::step);
}

FileTask::Next FileTask::follow() {
  for (;;) {
    const Exchange exchange = client_.job(entry_.job, etag_);
    if (exchange.ending != Ending::answered) return give_up(exchange);
    const HttpAnswer& answer = exchange.answer;
    if (answer.status == 304) continue;
    if (is_gone(answer.status)) return Next::start_over;
    const auto job = parse_json(answer.body);
    const auto state = job ? job_state_of_name(text_in(*job, "state")) : std::nullopt;
    if (answer.status != 200 || !state) return refuse(answer, false);
    if (is_final(*state)) return heed(*job);
    etag_ = answer.header("etag");
  }
}

/// What the end of a job means.
FileTask::Next FileTask::heed(const Json& job) {
  etag_.clear();
  const std::string state = text_in(job, "state");
  if (state == name_of(JobState::expired)) return Next::start_over;
  if (state == name_of(JobState::succeeded) && job.contains("result")) {
    expected_ = {text_in(job["result"], "sha256"), number_in(job["result"], "bytes")};
    return Next::step;
  }
  if (state == name_of(JobState::canceled)) {
    // Somebody wanted this job away; another run means another job.
    const Next over = fail(Error{ErrorCode::canceled, "The job was canceled on the server."});
    begin_attempt();
    return over;
  }
  const Json problem = job.contains("problem") ? job["problem"] : Json();
  if (problem.is_object()) return fail(problem, true);
  return fail(Error{ErrorCode::internal, "The job failed without a reason."}, true);
}

FileTask::Next FileTask::fetch() {
  const auto begin = [this] {
    auto part = context_.out.create_part();
    if (!part) {
      unwritable_ = part.error();
      return false;
    }
    part_.reset();
    part_.emplace(*std::move(part));
    digest_.emplace();
    received_ = 0;
    return true;
  };
  const auto receive = [this](std::string_view bytes) {
    const auto piece = std::as_bytes(std::span(bytes));
    digest_->update(piece);
    received_ += piece.size();
    if (auto written = write_all(part_->descriptor(), piece); !written) {
      unwritable_ = written.error();
    }
    return !unwritable_;
  };
  const auto check = [this](const HttpAnswer& answer) -> std::string {
    const std::string sha256 = digest_->hex();
    const auto stated = sha256_of_repr_digest(answer.header("repr-digest"));
    const bool whole = sha256 == expected_.sha256 && received_ == expected_.bytes;
    return whole && stated.value_or(sha256) == sha256 ? "" : "a result came damaged";
  };
  const Exchange exchange = client_.result(entry_.job, begin, receive, check);
  if (unwritable_) return fail(*unwritable_);
  if (exchange.ending != Ending::answered) return give_up(exchange);
  if (is_gone(exchange.answer.status)) return Next::start_over;
  if (exchange.answer.status != 200) return refuse(exchange.answer, false);
  return put_in_place();
}

FileTask::Next FileTask::put_in_place() {
  // Written down first: a crash in between must not leave a file that looks like a stranger's.
  entry_.result = expected_;
  if (write_down(Next::step) == Next::over) return Next::over;
  if (auto done = part_->commit(context_.out.result(file_.name)); !done) return fail(done.error());
  outcome_.state = FileState::succeeded;
  outcome_.sha256 = expected_.sha256;
  outcome_.result_bytes = expected_.bytes;
  return Next::over;
}

/// Forgets the job, so that the next submit means a new one.
FileTask::Next FileTask::begin_attempt() {
  entry_ = {.payload = entry_.payload, .attempt = entry_.attempt + 1};
  etag_.clear();
  return write_down(Next::step);
}

FileTask::Next FileTask::give_up(const Exchange& exchange) {
  lost_server_ = exchange.ending == Ending::no_server;
  outcome_.state = FileState::unfinished;
  if (exchange.ending == Ending::gave_up) outcome_.problem = problem_of(exchange.answer);
  return Next::over;
}

FileTask::Next FileTask::refuse(const HttpAnswer& answer, bool for_good) {
  // A server that cannot be trusted now will not be for the next file.
  lost_server_ = answer.lost == HttpAnswer::Lost::distrust;
  return fail(problem_of(answer), for_good);
}

FileTask::Next FileTask::fail(Json problem, bool for_good) {
  outcome_.state = FileState::failed;
  outcome_.problem = std::move(problem);
  if (!for_good) return Next::over;
  entry_.problem = outcome_.problem;
  entry_.server = to_string(context_.options.server);
  return write_down(Next::over);
}

FileTask::Next FileTask::fail(const Error& error, bool for_good) {
  return fail(problem_document(error), for_good);
}

FileTask::Next FileTask::write_down(Next then) {
  const auto written = context_.journal.put(file_.name, entry_);
  if (written) return then;
  outcome_.state = FileState::failed;
  outcome_.problem = problem_document(written.error());
  return Next::over;
}

}  // namespace fairway
