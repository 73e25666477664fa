#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "proto/messages/json.h"

namespace fairway {

inline constexpr std::size_t kMaxLabels = 16;
inline constexpr std::size_t kMaxLabelBytes = 100;
/// Of a job's priority, both ways: jobs of a higher one run first.
inline constexpr int kHighestPriority = 10;

/// Where the end of a job is told.
struct Webhook {
  std::string url;  ///< see webhook_url_complaint()
};

/// What a client may ask of a job beside its mesh and parameters.
struct JobOptions {
  std::vector<std::string> labels;  ///< sorted, each once; see is_label()
  int priority = 0;                 ///< −kHighestPriority … kHighestPriority
  /// How long input and result are kept after the job's end, 60 s … 365 days; else as the server
  /// is set.
  std::optional<std::chrono::seconds> ttl = {};
  /// Longest run, 1 s … 24 h; else, and at most, as the server is set.
  std::optional<std::chrono::seconds> deadline = {};
  std::optional<Webhook> webhook = {};
};

/// True for 1 … kMaxLabelBytes letters, digits and . _ : / @ + = -
bool is_label(std::string_view text);

/// Reads {"labels", "priority", "ttl", "deadline", "webhook": {"url"}}, strictly; times in whole
/// seconds. Errors: malformed_parameters, invalid_parameters with the pointer of the culprit.
Result<JobOptions> read_job_options(const Json& json);
/// The same of its text; of an empty one what nobody asked for.
Result<JobOptions> parse_job_options(std::string_view text);

/// What read_job_options() accepts, as JSON Schema (draft 2020-12).
Json job_options_schema();

/// The same document, with what was not asked for left out. It holds the webhook's whole URL.
Json job_options_document(const JobOptions& options);

}  // namespace fairway
