#include "server/fairwayd/store/job_row.h"

#include "proto/messages/problem.h"

namespace fairway {
namespace {

/// Hands out the columns of a row from left to right.
class Columns {
 public:
  explicit Columns(const Query& row) : row_(row) {}

  bool next_is_null() const { return row_.is_null(at_); }
  void skip(int count) { at_ += count; }
  std::int64_t integer() { return row_.integer(at_++); }
  std::string text() { return row_.text(at_++); }
  std::optional<std::int64_t> optional_integer() {
    const int column = at_++;
    return row_.is_null(column) ? std::nullopt : std::optional(row_.integer(column));
  }
  BlobInfo blob() {
    BlobInfo info;
    info.key = text();
    info.bytes = static_cast<std::uint64_t>(integer());
    info.sha256 = text();
    return info;
  }

 private:
  const Query& row_;
  int at_ = 0;
};

JobOptions stored_options(const std::string& text) {
  const auto options = parse_job_options(text);
  return options ? *options : JobOptions{};
}

std::optional<Error> stored_problem(Columns& columns) {
  if (columns.next_is_null()) {
    columns.skip(1);
    return std::nullopt;
  }
  auto json = parse_json(columns.text());
  if (!json) return Error{ErrorCode::internal, "The stored problem cannot be read."};
  return error_of_problem(*json);
}

}  // namespace

Job job_of(const Query& row) {
  Columns columns(row);
  Job job;
  job.number = columns.integer();
  job.tenant = columns.text();
  job.id = columns.text();
  job.state = job_state_of_name(columns.text()).value_or(JobState::expired);
  job.revision = columns.integer();
  job.attempt = static_cast<int>(columns.integer());
  job.fence = columns.integer();
  job.created = columns.integer();
  job.started = columns.optional_integer();
  job.finished = columns.optional_integer();
  job.expires = columns.optional_integer();
  job.options = stored_options(columns.text());
  job.cached = columns.integer() != 0;
  job.input = columns.blob();
  job.input_format = format_of_name(columns.text()).value_or(Format::glb);
  job.input_files = static_cast<std::size_t>(columns.integer());
  job.parameters = columns.text();
  job.trace_id = columns.text();
  job.problem = stored_problem(columns);
  job.report = columns.text();
  if (!columns.next_is_null()) {
    job.result = columns.blob();
    job.result_format = format_of_name(columns.text()).value_or(Format::glb);
  }
  return job;
}

Result<std::vector<Job>> read_jobs(Query query) {
  std::vector<Job> jobs;
  for (;;) {
    auto row = query.step();
    if (!row) return row.error();
    if (!*row) return jobs;
    jobs.push_back(job_of(query));
  }
}

void bind_result(Query& query, const Job& job) {
  if (!job.result) {
    query.bind_null().bind_null().bind_null().bind_null();
    return;
  }
  query.bind(job.result->key).bind(static_cast<std::int64_t>(job.result->bytes));
  query.bind(job.result->sha256).bind(name_of(job.result_format));
}

}  // namespace fairway
