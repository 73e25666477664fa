#include "tests/service/webhooks/webhook_receiver.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <sstream>

#include <catch2/catch.hpp>
#include <netinet/in.h>
#include <sys/socket.h>

#include "tests/service/support/job_follower.h"

namespace fairway::test {
namespace {

Received parse_head(const std::string& head) {
  Received post;
  std::istringstream lines(head);
  std::string method;
  std::string line;
  lines >> method >> post.target;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.size() > 1) {
    const std::size_t colon = line.find(':');
    std::string name = line.substr(0, colon);
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    post.headers[name] = line.substr(colon + 2, line.size() - colon - 3);
  }
  return post;
}

/// Reads one request; nothing where the connection ends before it does.
std::optional<Received> read_request(int connection) {
  std::string text;
  std::array<char, 4096> chunk;
  std::size_t body = std::string::npos;
  std::optional<Received> post;
  while (true) {
    if (!post && (body = text.find("\r\n\r\n")) != std::string::npos) {
      post = parse_head(text.substr(0, body + 2));
      body += 4;
    }
    if (post && text.size() - body >= std::stoul(post->headers.at("content-length"))) {
      post->body = text.substr(body);
      return post;
    }
    const ssize_t got = ::recv(connection, chunk.data(), chunk.size(), 0);
    if (got <= 0) return std::nullopt;
    text.append(chunk.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace

std::string answer_of(int status, const std::string& headers) {
  return "HTTP/1.1 " + std::to_string(status) + " X\r\n" + headers + "Content-Length: 0\r\n\r\n";
}

void Latch::open() {
  const std::lock_guard lock(mutex_);
  is_open_ = true;
  opened_.notify_all();
}

void Latch::wait() {
  std::unique_lock lock(mutex_);
  opened_.wait(lock, [this] { return is_open_; });
}

WebhookReceiver::WebhookReceiver(Answer answer)
    : answer_(std::move(answer)), socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  auto* any = reinterpret_cast<sockaddr*>(&address);
  socklen_t size = sizeof address;
  REQUIRE(::bind(socket_.get(), any, size) == 0);
  REQUIRE(::getsockname(socket_.get(), any, &size) == 0);
  port_ = ntohs(address.sin_port);
}

WebhookReceiver::~WebhookReceiver() {
  ::shutdown(socket_.get(), SHUT_RDWR);
  if (acceptor_.joinable()) acceptor_.join();
  for (std::thread& thread : threads_) thread.join();
}

void WebhookReceiver::open() {
  REQUIRE(::listen(socket_.get(), 64) == 0);
  acceptor_ = std::thread([this] { serve(); });
}

std::string WebhookReceiver::url(const std::string& path, const std::string& host) const {
  return "http://" + host + ":" + std::to_string(port_) + path;
}

void WebhookReceiver::serve() {
  while (true) {
    const int connection = ::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0) return;
    threads_.emplace_back([this, connection] { answer_one(connection); });
  }
}

void WebhookReceiver::answer_one(int descriptor) {
  const UniqueFd connection(descriptor);
  const auto post = read_request(descriptor);
  if (!post) return;
  std::size_t n = 0;
  {
    const std::lock_guard lock(mutex_);
    n = received_.size();
    received_.push_back(*post);
  }
  changed_.notify_all();
  const std::string answer = answer_(*post, n);
  // Who has hung up meanwhile is part of some tests.
  [[maybe_unused]] const auto sent = ::send(descriptor, answer.data(), answer.size(), MSG_NOSIGNAL);
}

std::vector<Received> WebhookReceiver::wait_for(std::size_t count) {
  std::unique_lock lock(mutex_);
  const bool came = changed_.wait_for(lock, kPatience, [&] { return received_.size() >= count; });
  CAPTURE(received_.size());
  REQUIRE(came);
  return received_;
}

}  // namespace fairway::test
