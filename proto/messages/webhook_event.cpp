#include "proto/messages/webhook_event.h"

#include <utility>

namespace fairway {

std::string webhook_event_type(JobState state) {
  return "job." + std::string(name_of(state));
}

Json webhook_event(const JobFacts& job) {
  Json data = job_document(job);
  data.erase("parameters");
  data.erase("report");
  return Json{{"type", webhook_event_type(job.state)},
              {"timestamp", rfc3339_utc(job.finished.value_or(job.created))},
              {"data", std::move(data)}};
}

}  // namespace fairway
