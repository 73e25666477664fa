// The one file that knows cpp-httplib. The library parses request lines and queries and writes
// responses; where a request begins and ends is decided before it, in Connection, and of a body it
// sees nothing: its own readers of bodies and forms, its limits and its routes by regular
// expression are never reached.
#include "server/fairwayd/http/http_engine.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include <httplib.h>
#include <unistd.h>

#include "server/fairwayd/http/multipart_reader.h"
#include "server/fairwayd/http/trace.h"

namespace fairway {
namespace {

constexpr std::size_t kFileChunk = 64 * 1024;
constexpr std::size_t kBodyChunk = 64 * 1024;

/// One request of a connection as the library's stream: the checked head, and nothing after it.
class RequestStream final : public httplib::Stream {
 public:
  explicit RequestStream(Connection& connection) : connection_(connection) {}

  void begin(std::string head) {
    head_ = std::move(head);
    at_ = 0;
  }

  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }

  ssize_t read(char* space, size_t size) override {
    const std::size_t count = std::min(size, head_.size() - at_);
    head_.copy(space, count, at_);
    at_ += count;
    return static_cast<ssize_t>(count);
  }

  ssize_t write(const char* bytes, size_t size) override {
    return connection_.send({bytes, size}) ? static_cast<ssize_t>(size) : -1;
  }

  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return connection_.descriptor(); }

 private:
  Connection& connection_;
  std::string head_;
  std::size_t at_ = 0;
};

std::string_view content_type_of(const RequestHead& head) {
  for (const auto& [name, value] : head.headers) {
    if (name == "content-type") return value;
  }
  return {};
}

class NoBody final : public BodySource {
 public:
  Result<void> read(const OnBytes&) override { return {}; }
  Result<void> read_parts(const OnPart&, const OnBytes&) override { return {}; }
  void interrupt() override {}
};

/// The body of the request at hand, past the library.
class ConnectionBody final : public BodySource {
 public:
  ConnectionBody(Connection& connection, const RequestHead& head)
      : connection_(connection), head_(head) {}

  Result<void> read(const OnBytes& on_bytes) override {
    std::vector<char> space(kBodyChunk);
    while (true) {
      const auto got = connection_.read_body(space);
      if (!got) return got.error();
      if (*got == 0) return {};
      auto taken = on_bytes(std::as_bytes(std::span(space).first(*got)));
      if (!taken) return taken;
    }
  }

  Result<void> read_parts(const OnPart& on_part, const OnBytes& on_bytes) override {
    const auto boundary = form_boundary(content_type_of(head_));
    if (!boundary) {
      return Error{ErrorCode::bad_request, "The body is not multipart/form-data with a boundary."};
    }
    MultipartReader reader(*boundary,
                           [this](std::span<char> space) { return connection_.read_body(space); });
    return reader.read(on_part, on_bytes);
  }

  void interrupt() override { connection_.stop_receiving(); }

 private:
  Connection& connection_;
  const RequestHead& head_;
};

void put_file(httplib::Response& to, FileBody file, const std::string& content_type) {
  const std::uint64_t bytes = file.size();
  const auto reader = std::make_shared<FileBodyReader>(std::move(file));
  to.set_content_provider(
      bytes, content_type, [reader](size_t, size_t length, httplib::DataSink& sink) {
        std::array<char, kFileChunk> chunk;
        const std::size_t got =
            reader->read(std::span(chunk).first(std::min(length, chunk.size())));
        return got > 0 && sink.write(chunk.data(), got);
      });
}

/// `chunked`: the client knows chunks; otherwise the end of the connection is the end of the body.
void put_stream(httplib::Response& to, HttpResponse& from, bool chunked) {
  const auto provider = [stream = std::move(from.stream)](size_t, httplib::DataSink& sink) {
    bool taken = true;
    stream([&](std::string_view bytes) {
      // The library takes an empty write for the end.
      if (taken && !bytes.empty()) taken = sink.write(bytes.data(), bytes.size());
      return taken;
    });
    if (taken) sink.done();
    return taken;
  };
  if (chunked) {
    to.set_chunked_content_provider(from.content_type, provider);
  } else {
    to.set_content_provider(from.content_type, provider);
  }
}

/// The library says more about bodies than is true: of answers that have none, and of HEAD.
void correct_headers(httplib::Response& to, bool takes_ranges) {
  constexpr int kNoContent = 204;
  constexpr int kNotModified = 304;
  if (to.status == kNoContent || to.status == kNotModified) to.headers.erase("Content-Length");
  if (!takes_ranges) to.headers.erase("Accept-Ranges");
}

/// The library's server without its sockets and threads: one per connection, so that handlers know
/// whom they talk to.
class Talk final : private httplib::Server {
 public:
  Talk(Connection& connection, HttpApplication& application, const Log& log,
       const ConnectionLimits& limits, std::size_t most_requests)
      : connection_(connection),
        application_(application),
        log_(log),
        requests_left_(most_requests),
        stream_(connection) {
    // The library sends bodies only while it believes that it listens.
    svr_sock_ = connection.descriptor();
    set_keep_alive_max_count(most_requests);
    set_keep_alive_timeout(std::chrono::ceil<std::chrono::seconds>(limits.idle).count());
    set_handlers();
  }

  void run();

 private:
  void set_handlers();
  bool serve_one(const RequestHead& head);
  bool process(const RequestHead& head);
  void tell_answered();
  HttpRequest request_of(const httplib::Request& from) const;
  void put(HttpResponse from, const httplib::Request& request, httplib::Response& to);
  void refuse(const Error& error);

  Connection& connection_;
  HttpApplication& application_;
  const Log& log_;
  std::size_t requests_left_;
  RequestStream stream_;
  const RequestHead* head_ = nullptr;  ///< of the request being answered
  bool close_ = false;                 ///< after this answer
  bool takes_ranges_ = false;          ///< as the application says
  HttpExchange exchange_;              ///< of the request being answered
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::uint64_t told_in_ = 0;  ///< bytes of the exchanges before
  std::uint64_t told_out_ = 0;
};

void Talk::set_handlers() {
  // All is answered here, before the library looks for a route or reads a body.
  set_pre_routing_handler([this](const httplib::Request& from, httplib::Response& to) {
    const HttpRequest request = request_of(from);
    if (application_.wants_body(request)) {
      ConnectionBody body(connection_, *head_);
      put(application_.answer(request, body), from, to);
    } else {
      NoBody body;
      put(application_.answer(request, body), from, to);
    }
    return HandlerResponse::Handled;
  });
  // What the library refuses by itself: a request line or headers it cannot read.
  set_error_handler(HandlerWithResponse([this](const httplib::Request& from,
                                               httplib::Response& to) {
    if (!to.body.empty() || to.content_provider_) return HandlerResponse::Unhandled;
    put(problem_response({ErrorCode::bad_request, "The request cannot be understood."}), from, to);
    close_ = true;
    return HandlerResponse::Handled;
  }));
  set_exception_handler([this](const httplib::Request& from, httplib::Response& to,
                               std::exception_ptr) {
    log_.write(LogLevel::error, "exception_in_answer");
    put(problem_response({ErrorCode::internal, "The server met a defect of its own."}), from, to);
    close_ = true;
  });
  set_post_routing_handler([this](const httplib::Request& from, httplib::Response& to) {
    exchange_.method = from.method;
    exchange_.path = from.path;
    exchange_.status = to.status;
    to.set_header("traceparent", format_traceparent(exchange_.trace));
    correct_headers(to, takes_ranges_);
    if (!close_) return;
    to.headers.erase("Connection");
    to.headers.erase("Keep-Alive");
    to.set_header("Connection", "close");
  });
}

HttpRequest Talk::request_of(const httplib::Request& from) const {
  HttpRequest request;
  request.method = from.method;
  request.path = from.path;
  for (const auto& [name, value] : from.params) request.query.emplace_back(name, value);
  request.headers = head_->headers;
  request.content_type = content_type_of(*head_);
  request.has_content_encoding = head_->has_content_encoding;
  request.has_length = head_->framing.chunked || head_->framing.length.has_value();
  request.content_length = head_->framing.length;
  request.trace = exchange_.trace;
  request.client_is_there = [this] { return connection_.client_is_there(); };
  return request;
}

void Talk::put(HttpResponse from, const httplib::Request& request, httplib::Response& to) {
  const bool chunked = request.version == "HTTP/1.1";
  close_ = close_ || from.close || !connection_.body_is_over() || (from.stream && !chunked);
  takes_ranges_ = false;
  to.status = from.status;
  to.body.clear();
  for (const auto& [name, value] : from.headers) {
    to.set_header(name, value);
    takes_ranges_ = takes_ranges_ || name == "Accept-Ranges";
  }
  if (from.file) {
    put_file(to, std::move(*from.file), from.content_type);
  } else if (from.stream) {
    put_stream(to, from, chunked);
  } else if (!from.body.empty()) {
    to.set_content(from.body, from.content_type);
  }
}

/// Answers a request whose head cannot even be given to the library.
void Talk::refuse(const Error& error) {
  exchange_ = {};
  exchange_.trace = trace_of({});
  exchange_.status = problem_response(error).status;
  began_ = std::chrono::steady_clock::now();
  connection_.send(refusal_message(error));
  tell_answered();
  connection_.finish_refused();
}

/// Serves one request and tells the application how that went.
bool Talk::serve_one(const RequestHead& head) {
  exchange_ = {};
  exchange_.trace = trace_of(head.headers);
  began_ = std::chrono::steady_clock::now();
  const bool goes_on = process(head);
  tell_answered();
  return goes_on;
}

void Talk::tell_answered() {
  exchange_.took = std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::steady_clock::now() - began_);
  exchange_.bytes_in = connection_.bytes_received() - told_in_;
  exchange_.bytes_out = connection_.bytes_sent() - told_out_;
  told_in_ += exchange_.bytes_in;
  told_out_ += exchange_.bytes_out;
  application_.answered(exchange_);
}

bool Talk::process(const RequestHead& head) {
  head_ = &head;
  close_ = !head.keep_alive || requests_left_ == 0;
  stream_.begin(head.text);
  bool closed = false;
  const bool answered = process_request(stream_, close_, closed, nullptr);
  if (!connection_.body_is_over()) connection_.finish_refused();
  return answered && !close_ && connection_.body_is_over();
}

void Talk::run() {
  while (requests_left_ > 0) {
    auto head = connection_.read_head();
    --requests_left_;
    if (!head) return refuse(head.error());
    if (!*head || !serve_one(**head)) return;
  }
}

}  // namespace

#ifdef __SANITIZE_THREAD__
}  // namespace fairway
// The library is not instrumented: ThreadSanitizer does not see that its function-local statics are
// initialised once, and takes that for a race.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:libcpp-httplib.so";
}
namespace fairway {
#endif

void serve_connection(Connection& connection, HttpApplication& application, const Log& log,
                      const ConnectionLimits& limits, std::size_t most_requests) {
  application.connections_changed(+1);
  Talk(connection, application, log, limits, most_requests).run();
  application.connections_changed(-1);
}

}  // namespace fairway
