#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>

namespace fairway {

/// Every way in which fairway can refuse or fail. Closed: `proto/messages/problem.h` holds the one
/// table that maps each code to an HTTP status, a problem type and an exit code.
enum class ErrorCode : std::uint8_t {
  malformed_input,       ///< the bytes do not parse as their format
  unsupported_format,    ///< not a format fairway reads, or a version of it that it does not
  unsupported_feature,   ///< well-formed, but needs something fairway does not implement
  invalid_mesh,          ///< parses, but breaks a rule of its format or has unusable geometry
  no_triangles,          ///< nothing to denoise
  malformed_parameters,  ///< the parameter document is not JSON
  invalid_parameters,    ///< JSON, but with an unknown key, a wrong type or a value out of range
  too_large,             ///< above a stated limit of size
  diverged,              ///< the flow left the range of finite, bounded positions
  memory_limit,          ///< the worker reached its address-space limit
  time_limit,            ///< the worker reached its deadline
  decoder_failed,        ///< the worker died twice while it decoded the input
  worker_crashed,        ///< the worker died twice on this job while its server lived
  canceled,              ///< stopped on request
  bad_request,           ///< HTTP request that cannot be understood
  length_required,       ///< HTTP request without a length
  not_found,
  method_not_allowed,
  not_ready,  ///< the job has no result yet
  gone,       ///< the job had a result, which has expired or was deleted
  conflict,
  key_reused,  ///< an idempotency key came with two different requests
  queue_full,
  storage_full,
  unavailable,            ///< the service cannot take work now
  usage,                  ///< command line not understood
  io,                     ///< a file could not be read or written
  not_acceptable,         ///< the client excludes the only form that there is
  precondition_failed,    ///< If-Match names another version
  range_not_satisfiable,  ///< Range lies outside, or asks for too much at once
  uri_too_long,           ///< request line above its limit
  headers_too_large,      ///< request head above a limit
  request_timeout,        ///< the request came too slowly
  unauthorized,           ///< no key, or one that is not good
  forbidden,              ///< who asks may not do that
  rate_limited,           ///< too many submits in a short time
  quota_exceeded,         ///< a tenant keeps as much as it may
  checksum_mismatch,      ///< bytes came that are not those of their checksum
  internal,               ///< a defect of fairway
};

/// An expected failure: what went wrong in one sentence that names the remedy, and, for documents,
/// the JSON pointer (RFC 6901) of the culprit.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;
  std::string pointer = {};
};

/// A value or an Error. `if (!r) return r.error();`
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT: implicit
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT: implicit

  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() & { return std::get<0>(state_); }
  const T& operator*() const& { return std::get<0>(state_); }
  T&& operator*() && { return std::get<0>(std::move(state_)); }
  T* operator->() { return &std::get<0>(state_); }
  const T* operator->() const { return &std::get<0>(state_); }
  const Error& error() const { return std::get<1>(state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success without a value, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), ok_(false) {}  // NOLINT: implicit

  explicit operator bool() const { return ok_; }
  const Error& error() const { return error_; }

 private:
  Error error_;
  bool ok_ = true;
};

}  // namespace fairway
