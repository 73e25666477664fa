#pragma once

#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/store/sqlite.h"

namespace fairway {

// The columns of job_of(), in its order. A macro, because SQL texts are literals put together at
// compile time: the statement cache keys on them.
#define FAIRWAY_JOB_COLUMNS                                                                        \
  "seq, tenant, id, state, revision, attempt, fence, created, started, finished, expires, "        \
  "options, cached, input_key, input_bytes, input_sha256, input_format, input_files, parameters, " \
  "trace_id, problem, report, result_key, result_bytes, result_sha256, result_format"

/// The row that a query over FAIRWAY_JOB_COLUMNS stands at.
Job job_of(const Query& row);

/// All rows of such a query.
Result<std::vector<Job>> read_jobs(Query query);

/// Binds key, bytes, digest and format of the result, or four times NULL.
void bind_result(Query& query, const Job& job);

}  // namespace fairway
