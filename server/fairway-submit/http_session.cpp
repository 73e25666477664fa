// The one file of the batch client that knows cpp-httplib.

#include "server/fairway-submit/http_session.h"

#include <array>
#include <cctype>
#include <optional>
#include <utility>

#include <httplib.h>
#include <poll.h>

namespace fairway {
namespace {

constexpr time_t kConnectSeconds = 10;
/// Longer than a long poll.
constexpr time_t kReadSeconds = 90;
constexpr time_t kWriteSeconds = 60;
constexpr int kOk = 200;
constexpr std::size_t kMostText = std::size_t{16} << 20;
constexpr std::size_t kChunk = 64 * 1024;

/// The library sends a body to its end before it looks for an answer. A server that refuses an
/// upload answers in the middle and closes; what it said would be lost in a broken pipe. So an
/// answer that begins early, or a write that fails, ends the sending and lets the library read.
class RefusableStream final : public httplib::Stream {
 public:
  explicit RefusableStream(httplib::Stream& inner) : inner_(inner) {}

  bool ended_early() const { return ended_early_; }

  bool is_readable() const override { return inner_.is_readable(); }
  bool is_writable() const override { return ended_early_ || inner_.is_writable(); }
  ssize_t read(char* space, size_t size) override { return inner_.read(space, size); }
  ssize_t write(const char* bytes, size_t size) override {
    pollfd entry{inner_.socket(), POLLIN, 0};
    ended_early_ = ended_early_ || ::poll(&entry, 1, 0) > 0;
    if (ended_early_) return static_cast<ssize_t>(size);
    const ssize_t written = inner_.write(bytes, size);
    if (written >= 0) return written;
    ended_early_ = true;
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    inner_.get_remote_ip_and_port(ip, port);
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    inner_.get_local_ip_and_port(ip, port);
  }
  socket_t socket() const override { return inner_.socket(); }

 private:
  httplib::Stream& inner_;
  bool ended_early_ = false;
};

class PlainClient final : public httplib::ClientImpl {
 public:
  using ClientImpl::ClientImpl;

  /// True after a request whose body was not sent to its end.
  bool ended_early() const { return ended_early_; }

 private:
  bool process_socket(const Socket& socket,
                      std::function<bool(httplib::Stream&)> callback) override {
    return httplib::detail::process_client_socket(
        socket.sock, read_timeout_sec_, read_timeout_usec_, write_timeout_sec_, write_timeout_usec_,
        [this, &callback](httplib::Stream& inner) {
          RefusableStream stream(inner);
          const bool done = callback(stream);
          ended_early_ = stream.ended_early();
          return done;
        });
  }

  bool ended_early_ = false;
};

std::unique_ptr<httplib::SSLClient> encrypted_client(const HttpSettings& settings) {
  auto client = std::make_unique<httplib::SSLClient>(settings.server.host, settings.server.port);
  if (!settings.ca_certificate.empty()) client->set_ca_cert_path(settings.ca_certificate);
  client->enable_server_certificate_verification(true);
  return client;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string reason_of(httplib::Error error) {
  switch (error) {
    case httplib::Error::Connection:
      return "no connection";
    case httplib::Error::ConnectionTimeout:
      return "the connection was not answered in time";
    case httplib::Error::Read:
      return "the connection broke before the answer";
    case httplib::Error::Write:
      return "the connection broke while the request was sent";
    case httplib::Error::SSLConnection:
      return "no encrypted connection: does the server speak TLS?";
    case httplib::Error::SSLLoadingCerts:
      return "the certificates to trust cannot be read";
    case httplib::Error::SSLServerVerification:
      return "the server's certificate is not trusted; --ca-cert names another authority";
    default:
      return httplib::to_string(error);
  }
}

HttpAnswer answer_of(const httplib::Result& result) {
  HttpAnswer answer;
  if (!result) {
    const httplib::Error error = result.error();
    const bool distrust =
        error == httplib::Error::SSLServerVerification || error == httplib::Error::SSLLoadingCerts;
    answer.lost = distrust                            ? HttpAnswer::Lost::distrust
                  : error == httplib::Error::Canceled ? HttpAnswer::Lost::by_receiver
                                                      : HttpAnswer::Lost::connection;
    answer.reason = reason_of(error);
    return answer;
  }
  answer.status = result->status;
  answer.body = result->body;
  for (const auto& [name, value] : result->headers) answer.headers.emplace(lower(name), value);
  return answer;
}

}  // namespace

std::string HttpAnswer::header(const std::string& lower_name) const {
  const auto found = headers.find(lower_name);
  return found == headers.end() ? "" : found->second;
}

class HttpSession::Client {
 public:
  explicit Client(const HttpSettings& settings) : prefix_(settings.server.prefix) {
    if (settings.server.encrypted) {
      library_ = encrypted_client(settings);
    } else {
      auto plain = std::make_unique<PlainClient>(settings.server.host, settings.server.port);
      plain_ = plain.get();
      library_ = std::move(plain);
    }
    library_->set_keep_alive(true);
    library_->set_url_encode(false);
    library_->set_connection_timeout(kConnectSeconds);
    library_->set_read_timeout(kReadSeconds);
    library_->set_write_timeout(kWriteSeconds);
    // A compressed result would not be the bytes that its digest is of.
    httplib::Headers always{{"Accept-Encoding", "identity"}, {"User-Agent", "fairway-submit"}};
    if (!settings.api_key.empty()) always.emplace("Authorization", "Bearer " + settings.api_key);
    library_->set_default_headers(always);
  }

  httplib::ClientImpl& library() { return *library_; }
  std::string path(const std::string& path) const { return prefix_ + path; }
  /// Nothing else may go over a connection that still waits for the rest of a body.
  void drop_unfinished() {
    if (plain_ != nullptr && plain_->ended_early()) library_->stop();
  }

 private:
  std::unique_ptr<httplib::ClientImpl> library_;
  PlainClient* plain_ = nullptr;  ///< the library's, where it is one
  std::string prefix_;
};

HttpSession::HttpSession(const HttpSettings& settings)
    : client_(std::make_unique<Client>(settings)) {}

HttpSession::~HttpSession() = default;

HttpAnswer HttpSession::get(const std::string& path, const Headers& headers,
                            const Receiver& receiver) {
  bool wanted = false;
  std::string text;
  const auto on_head = [&](const httplib::Response& response) {
    wanted = receiver && response.status == kOk;
    return true;
  };
  const auto on_bytes = [&](const char* bytes, size_t size) {
    if (wanted) return receiver({bytes, size});
    text.append(bytes, size);
    return text.size() <= kMostText;
  };
  // The library waits for a body after 304 until the connection ends.
  client_->library().set_keep_alive(!headers.contains("If-None-Match"));
  HttpAnswer answer = answer_of(client_->library().Get(
      client_->path(path), httplib::Headers(headers.begin(), headers.end()), on_head, on_bytes));
  answer.body = std::move(text);
  return answer;
}

HttpAnswer HttpSession::post(const std::string& path, const Headers& headers,
                             const Payload& payload) {
  std::optional<Error> unreadable;
  const auto provider = [&](size_t offset, size_t length, httplib::DataSink& sink) {
    std::array<char, kChunk> chunk;
    const auto got = payload.read(offset, std::span(chunk).first(std::min(length, chunk.size())));
    if (got && *got > 0) {
      sink.write(chunk.data(), *got);
      return true;
    }
    unreadable = got ? Error{ErrorCode::io, "it became shorter while it was sent"} : got.error();
    return false;
  };
  client_->library().set_keep_alive(true);
  HttpAnswer answer = answer_of(client_->library().Post(
      client_->path(path), httplib::Headers(headers.begin(), headers.end()),
      static_cast<size_t>(payload.size()), provider, payload.content_type()));
  client_->drop_unfinished();
  if (unreadable && answer.status == 0) {
    answer.lost = HttpAnswer::Lost::by_receiver;
    answer.reason = unreadable->message;
  }
  return answer;
}

void HttpSession::stop() {
  client_->library().stop();
}

}  // namespace fairway
