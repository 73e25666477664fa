#pragma once

#include "proto/messages/job_document.h"
#include "server/fairwayd/store/job_store.h"

namespace fairway {

/// What a job's row says, without its long documents (parameters, report) and without what the row
/// does not know (progress, place in the queue).
JobFacts facts_of(const Job& job);

}  // namespace fairway
