#pragma once

#include "server/fairwayd/http/http_conditions.h"
#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/store/job_store.h"

namespace fairway {

/// The entity tag of a job's document: W/"r5" at revision 5. Weak, because what is not part of the
/// state (progress) changes the document's bytes within a revision.
EntityTag version_of(const Job& job);

/// Says which revision an answer is about, and that caches ask again before they use it.
void add_version(HttpResponse& response, const Job& job);

}  // namespace fairway
