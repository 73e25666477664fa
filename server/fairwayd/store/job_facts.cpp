#include "server/fairwayd/store/job_facts.h"

namespace fairway {

JobFacts facts_of(const Job& job) {
  JobFacts facts;
  facts.id = job.id;
  facts.state = job.state;
  facts.revision = job.revision;
  facts.attempt = job.attempt;
  facts.created = job.created;
  facts.started = job.started;
  facts.finished = job.finished;
  facts.input = {job.input_format, job.input.bytes, job.input.sha256, job.input_files};
  facts.options = job.options;
  facts.cached = job.cached;
  facts.expires = job.expires;
  facts.problem = job.problem;
  if (job.result) facts.result = {job.result_format, job.result->bytes, job.result->sha256};
  return facts;
}

}  // namespace fairway
