// The one file that knows cpp-httplib. The library parses request lines, queries and multipart
// bodies and writes responses; where a request begins and ends, and what of it the library gets to
// see, is decided before it, in Connection.
#include "server/fairwayd/http/http_engine.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include <httplib.h>
#include <unistd.h>

#include "server/fairwayd/http/trace.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxRequestsPerConnection = 1000;
constexpr std::size_t kFileChunk = 64 * 1024;
constexpr std::size_t kBodyChunk = 64 * 1024;

/// One request of a connection as the library's stream: the checked head, then the body.
class RequestStream final : public httplib::Stream {
 public:
  explicit RequestStream(Connection& connection) : connection_(connection) {}

  void begin(std::string head) {
    head_ = std::move(head);
    at_ = 0;
    error_.reset();
  }
  const std::optional<Error>& error() const { return error_; }

  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }

  ssize_t read(char* space, size_t size) override {
    if (at_ < head_.size()) {
      const std::size_t count = std::min(size, head_.size() - at_);
      head_.copy(space, count, at_);
      at_ += count;
      return static_cast<ssize_t>(count);
    }
    auto got = connection_.read_body({space, size});
    if (got) return static_cast<ssize_t>(*got);
    error_ = got.error();
    return -1;
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
  std::optional<Error> error_;
};

class NoBody final : public BodySource {
 public:
  Result<void> read(const OnBytes&) override { return {}; }
  Result<void> read_parts(const OnPart&, const OnBytes&) override { return {}; }
  void interrupt() override {}
};

class LibraryBody final : public BodySource {
 public:
  LibraryBody(const httplib::ContentReader& reader, bool multipart, const RequestStream& stream,
              Connection& connection)
      : reader_(reader), multipart_(multipart), stream_(stream), connection_(connection) {}

  /// Past the library, which would pass a body on in pieces of 4 KiB.
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
    if (!multipart_) return Error{ErrorCode::bad_request, "The body is not multipart/form-data."};
    const auto on_head = [&](const httplib::MultipartFormData& part) {
      return keep(on_part({part.name, part.filename, part.content_type}));
    };
    return verdict(reader_(on_head, receiver(on_bytes)));
  }

  void interrupt() override { connection_.stop_receiving(); }

 private:
  httplib::ContentReceiver receiver(const OnBytes& on_bytes) {
    return [this, &on_bytes](const char* bytes, size_t size) {
      return keep(on_bytes(std::as_bytes(std::span(bytes, size))));
    };
  }

  bool keep(Result<void> said) {
    if (!said) refused_ = said.error();
    return static_cast<bool>(said);
  }

  Result<void> verdict(bool read_all) const {
    if (refused_) return *refused_;
    if (stream_.error()) return *stream_.error();
    if (!read_all) {
      return Error{ErrorCode::bad_request,
                   "The body is not well-formed multipart/form-data: check boundary and parts."};
    }
    return {};
  }

  const httplib::ContentReader& reader_;
  bool multipart_;
  const RequestStream& stream_;
  Connection& connection_;
  std::optional<Error> refused_;
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
       const ConnectionLimits& limits)
      : connection_(connection), application_(application), log_(log), stream_(connection) {
    // The library sends bodies only while it believes that it listens.
    svr_sock_ = connection.descriptor();
    set_keep_alive_max_count(kMaxRequestsPerConnection);
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
  set_pre_routing_handler([this](const httplib::Request& from, httplib::Response& to) {
    const HttpRequest request = request_of(from);
    if (application_.wants_body(request)) return HandlerResponse::Unhandled;
    NoBody body;
    put(application_.answer(request, body), from, to);
    return HandlerResponse::Handled;
  });
  const HandlerWithContentReader with_body = [this](const httplib::Request& from,
                                                    httplib::Response& to,
                                                    const httplib::ContentReader& reader) {
    LibraryBody body(reader, from.is_multipart_form_data(), stream_, connection_);
    put(application_.answer(request_of(from), body), from, to);
  };
  constexpr const char* kAnyPath = "/.*";
  Post(kAnyPath, with_body);
  Put(kAnyPath, with_body);
  Patch(kAnyPath, with_body);
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
  request.content_type = request.header("content-type").value_or("");
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
  close_ = !head.keep_alive;
  stream_.begin(head.text);
  bool closed = false;
  const bool answered = process_request(stream_, close_, closed, nullptr);
  if (!connection_.body_is_over()) connection_.finish_refused();
  return answered && !close_ && connection_.body_is_over();
}

void Talk::run() {
  for (std::size_t i = 0; i < kMaxRequestsPerConnection; ++i) {
    auto head = connection_.read_head();
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
                      const ConnectionLimits& limits) {
  application.connections_changed(+1);
  Talk(connection, application, log, limits).run();
  application.connections_changed(-1);
}

}  // namespace fairway
