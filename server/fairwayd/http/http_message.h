#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"
#include "proto/messages/json.h"
#include "server/fairwayd/http/file_body.h"

namespace fairway {

using NameValues = std::vector<std::pair<std::string, std::string>>;

/// Where a request stands in a trace of several services (W3C Trace Context).
struct TraceContext {
  std::string trace_id;  ///< 32 hexadecimal digits
  std::string span_id;   ///< 16, of what this server does with the request
  bool sampled = false;  ///< the caller records this trace
};

/// A request without its body, decoded and within limits. All text is the client's.
struct HttpRequest {
  std::string method;
  std::string path;                             ///< percent-decoded, without the query
  NameValues query;                             ///< percent-decoded, in no particular order
  NameValues headers;                           ///< names in lower case, as they came
  std::string content_type;                     ///< with its parameters; empty if absent
  bool has_content_encoding = false;            ///< other than identity
  bool has_length = false;                      ///< framed by Content-Length or chunks
  std::optional<std::uint64_t> content_length;  ///< where it is declared
  TraceContext trace;                           ///< see trace_of()
  /// False once the client has hung up. May be asked from the thread that answers.
  std::function<bool()> client_is_there = [] { return true; };

  /// The value of the header, by its name in lower case; of several the first.
  std::optional<std::string_view> header(std::string_view name) const;
};

/// Takes a piece of a body that is made while it is sent. False: nobody reads any more.
using BodySink = std::function<bool(std::string_view)>;

/// An answer. The body is `file` or `stream` if there is one, otherwise `body`.
struct HttpResponse {
  int status = 200;
  std::string content_type;
  std::string body;
  std::optional<FileBody> file = {};
  /// Called in the thread that answers, with all of the head sent; returns at the end of the body,
  /// or when the sink refuses. Not called for HEAD.
  std::function<void(const BodySink&)> stream = {};
  NameValues headers = {};
  bool close = false;      ///< end the connection after this answer
  std::string cause = {};  ///< what the log is to say of a failure; never sent
};

/// One request and its answer, once that has been sent.
struct HttpExchange {
  std::string method;  ///< the client's text; both empty where the request could not be understood
  std::string path;
  int status = 0;
  std::uint64_t bytes_in = 0;   ///< on the wire, as far as they were read
  std::uint64_t bytes_out = 0;  ///< on the wire
  std::chrono::microseconds took{0};
  TraceContext trace;
};

/// The head of one part of a multipart body.
struct PartHead {
  std::string name;
  std::string file_name;
  std::string content_type;
};

/// A request's body as it arrives. One of the two reads may be called, once. What a callback
/// refuses ends the reading, and its Error is returned.
class BodySource {
 public:
  virtual ~BodySource() = default;

  using OnBytes = std::function<Result<void>(std::span<const std::byte>)>;
  using OnPart = std::function<Result<void>(const PartHead&)>;

  /// The whole body, in pieces. Errors: bad_request (cut short, badly framed), too_large,
  /// request_timeout.
  virtual Result<void> read(const OnBytes& on_bytes) = 0;

  /// A multipart/form-data body: `on_part` at each head, then `on_bytes` with its content.
  /// Errors: as read(), bad_request (not multipart).
  virtual Result<void> read_parts(const OnPart& on_part, const OnBytes& on_bytes) = 0;

  /// Takes the body for cut short where its reading is now. Does not wait. From any thread, as long
  /// as the source lives.
  virtual void interrupt() = 0;
};

/// A JSON document as an answer.
HttpResponse json_response(const Json& json, int status = 200);

/// The problem document of an error as an answer.
HttpResponse problem_response(const Error& error);

/// The same as a whole HTTP/1.1 message that ends the connection: for what is refused before a
/// request has been understood.
std::string refusal_message(const Error& error);

}  // namespace fairway
