#pragma once

#include <string>

#include "proto/messages/json.h"
#include "server/fairway-submit/batch.h"
#include "server/fairway-submit/options.h"

namespace fairway {

/// The summary of `--json`: batch, server, out, exit_code, seconds, counts by state, and per file
/// its name, state, job, result, bytes, seconds and problem. What is not known is absent.
Json summary_document(const BatchReport& report, const SubmitOptions& options);

/// The same for a person, in a line or two.
std::string summary_text(const BatchReport& report, const SubmitOptions& options);

}  // namespace fairway
