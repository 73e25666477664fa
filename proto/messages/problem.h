#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "proto/messages/json.h"

namespace fairway {

/// One row of the table that maps an ErrorCode to the outside.
struct ProblemKind {
  ErrorCode code;
  std::string_view slug;  ///< "invalid_mesh": stable, machine-readable
  int status;             ///< HTTP status
  int exit_code;          ///< of the tool, 1 … 119
  std::string_view title;
};

/// The row of a code. Total.
const ProblemKind& problem_kind(ErrorCode code);

/// The code of a slug; `internal` for an unknown slug.
ErrorCode error_code_of_slug(std::string_view slug);

/// RFC 9457 problem document: type "urn:fairway:problem:<slug>", title, status, detail, code, and
/// `pointer` where the error names a place in a document.
Json problem_document(const Error& error);

/// The error that a problem document states (for reading back stored problems).
Error error_of_problem(const Json& problem);

inline constexpr std::string_view kProblemMediaType = "application/problem+json";

}  // namespace fairway
