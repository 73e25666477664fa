#pragma once

#include <string>

#include "proto/messages/job_document.h"
#include "proto/messages/json.h"

namespace fairway {

/// What a webhook is told of a job's end: "job.succeeded", "job.failed", "job.canceled".
std::string webhook_event_type(JobState state);

/// The event of a job that has ended, in the shape of Standard Webhooks: {"type", "timestamp": of
/// the end, "data": the job document without its long parts, parameters and report}.
Json webhook_event(const JobFacts& job);

}  // namespace fairway
