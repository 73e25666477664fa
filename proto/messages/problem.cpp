// The one table of everything that can go wrong, and its RFC 9457 form.

#include "proto/messages/problem.h"

#include <algorithm>
#include <array>

namespace fairway {
namespace {

using enum ErrorCode;

constexpr std::array kKinds = {
    ProblemKind{malformed_input, "malformed_input", 400, 10, "The input cannot be parsed"},
    ProblemKind{unsupported_format, "unsupported_format", 415, 11, "Unsupported format"},
    ProblemKind{unsupported_feature, "unsupported_feature", 422, 12, "Unsupported feature"},
    ProblemKind{invalid_mesh, "invalid_mesh", 422, 13, "Invalid mesh"},
    ProblemKind{no_triangles, "no_triangles", 422, 14, "No triangles to denoise"},
    ProblemKind{malformed_parameters, "malformed_parameters", 400, 15,
                "The parameters cannot be parsed"},
    ProblemKind{invalid_parameters, "invalid_parameters", 422, 16, "Invalid parameters"},
    ProblemKind{too_large, "too_large", 413, 17, "Too large"},
    ProblemKind{diverged, "diverged", 422, 18, "The flow diverged"},
    ProblemKind{memory_limit, "memory_limit", 422, 19, "Memory limit reached"},
    ProblemKind{time_limit, "time_limit", 422, 20, "Time limit reached"},
    ProblemKind{decoder_failed, "decoder_failed", 422, 23, "The input broke its decoder"},
    ProblemKind{worker_crashed, "worker_crashed", 422, 21, "The input broke the worker"},
    ProblemKind{canceled, "canceled", 409, 22, "Canceled"},
    ProblemKind{bad_request, "bad_request", 400, 30, "Bad request"},
    ProblemKind{length_required, "length_required", 411, 31, "Length required"},
    ProblemKind{not_found, "not_found", 404, 32, "Not found"},
    ProblemKind{method_not_allowed, "method_not_allowed", 405, 33, "Method not allowed"},
    ProblemKind{not_ready, "not_ready", 409, 34, "Not ready"},
    ProblemKind{gone, "gone", 410, 35, "Gone"},
    ProblemKind{conflict, "conflict", 409, 36, "Conflict"},
    ProblemKind{key_reused, "key_reused", 422, 42, "Idempotency-Key reused"},
    ProblemKind{queue_full, "queue_full", 429, 37, "The queue is full"},
    ProblemKind{storage_full, "storage_full", 507, 38, "Storage is full"},
    ProblemKind{unavailable, "unavailable", 503, 39, "Unavailable"},
    ProblemKind{usage, "usage", 400, 2, "Wrong usage"},
    ProblemKind{io, "io", 500, 40, "A file could not be read or written"},
    ProblemKind{not_acceptable, "not_acceptable", 406, 50, "Not acceptable"},
    ProblemKind{precondition_failed, "precondition_failed", 412, 51, "Precondition failed"},
    ProblemKind{range_not_satisfiable, "range_not_satisfiable", 416, 52, "Range not satisfiable"},
    ProblemKind{uri_too_long, "uri_too_long", 414, 53, "Address too long"},
    ProblemKind{headers_too_large, "headers_too_large", 431, 54, "Headers too large"},
    ProblemKind{request_timeout, "request_timeout", 408, 55, "Request timeout"},
    ProblemKind{unauthorized, "unauthorized", 401, 56, "Unauthorized"},
    ProblemKind{forbidden, "forbidden", 403, 57, "Forbidden"},
    ProblemKind{rate_limited, "rate_limited", 429, 58, "Too many requests"},
    ProblemKind{quota_exceeded, "quota_exceeded", 507, 59, "Quota exceeded"},
    ProblemKind{checksum_mismatch, "checksum_mismatch", 460, 60, "Checksum mismatch"},
    ProblemKind{internal, "internal", 500, 41, "Internal error"},
};

// The table is indexed by the code: a code without a row does not compile.
static_assert(kKinds.size() == static_cast<std::size_t>(internal) + 1);
static_assert([] {
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (static_cast<std::size_t>(kKinds[i].code) != i) return false;
  }
  return true;
}());

constexpr std::string_view kTypePrefix = "urn:fairway:problem:";

}  // namespace

const ProblemKind& problem_kind(ErrorCode code) {
  return kKinds[static_cast<std::size_t>(code)];
}

ErrorCode error_code_of_slug(std::string_view slug) {
  const auto* it = std::find_if(kKinds.begin(), kKinds.end(),
                                [slug](const ProblemKind& kind) { return kind.slug == slug; });
  return it == kKinds.end() ? internal : it->code;
}

Json problem_document(const Error& error) {
  const ProblemKind& kind = problem_kind(error.code);
  Json problem = {{"type", std::string(kTypePrefix) + std::string(kind.slug)},
                  {"title", kind.title},
                  {"status", kind.status},
                  {"detail", error.message},
                  {"code", kind.slug}};
  if (!error.pointer.empty()) problem["pointer"] = error.pointer;
  return problem;
}

Error error_of_problem(const Json& problem) {
  const auto text = [&problem](const char* key) {
    const auto it = problem.is_object() ? problem.find(key) : problem.end();
    return it != problem.end() && it->is_string() ? it->get<std::string>() : std::string();
  };
  return {error_code_of_slug(text("code")), text("detail"), text("pointer")};
}

}  // namespace fairway
