#include "server/fairwayd/http/http_server.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "server/os/file.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxThreads = 512;

UniqueFd spare_descriptor() {
  return UniqueFd(::open("/dev/null", O_RDONLY | O_CLOEXEC));
}

/// Tells a client in one piece, without waiting for it, that there is no place. What it has sent is
/// taken from the socket, because closing it over that would take the answer back.
void turn_away(const UniqueFd& socket) {
  const std::string busy = refusal_message({ErrorCode::unavailable, "Too many connections."});
  ::send(socket.get(), busy.data(), busy.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  ::shutdown(socket.get(), SHUT_WR);
  std::array<char, 4096> unread;
  ::recv(socket.get(), unread.data(), unread.size(), MSG_DONTWAIT);
}

}  // namespace

HttpServer::HttpServer(Listener listener, HttpApplication& application, const Log& log,
                       const ConnectionLimits& limits, const EventFlag& stopping)
    : limits_(limits),
      listener_(std::move(listener)),
      application_(application),
      log_(log),
      stopping_(stopping) {}

HttpServer::~HttpServer() {
  if (acceptor_.joinable()) acceptor_.join();
  std::vector<std::jthread> threads;
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    threads.swap(threads_);
  }
  for (std::jthread& thread : threads) thread.request_stop();
}

void HttpServer::start() {
  reserve_ = spare_descriptor();
  acceptor_ = std::jthread([this] { accept_all(); });
}

void HttpServer::accept_all() {
  while (true) {
    std::array<pollfd, 2> entries{
        {{listener_.socket.get(), POLLIN, 0}, {stopping_.descriptor(), POLLIN, 0}}};
    ::poll(entries.data(), entries.size(), -1);
    if (entries[1].revents != 0) break;
    UniqueFd socket(::accept4(listener_.socket.get(), nullptr, nullptr, SOCK_CLOEXEC));
    if (socket) {
      tell_accepting(true, 0);
      take(std::move(socket));
    } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
      tell_accepting(false, errno);
      turn_one_away();
    }
  }
  listener_.socket.reset();  // further clients are refused by the system
}

/// Only changes are logged.
void HttpServer::tell_accepting(bool works, int error_number) {
  if (works == accepts_) return;
  accepts_ = works;
  if (works) {
    log_.write(LogLevel::info, "accepting_again");
  } else {
    log_.write(LogLevel::error, "accept_failed",
               {{"reason", system_sentence("accept a connection", error_number)}});
  }
}

/// No descriptor is left: a client would wait unheard.
void HttpServer::turn_one_away() {
  reserve_.reset();
  UniqueFd socket(::accept4(listener_.socket.get(), nullptr, nullptr, SOCK_CLOEXEC));
  const bool accepted = static_cast<bool>(socket);
  if (accepted) turn_away(socket);
  socket.reset();
  reserve_ = spare_descriptor();
  // Whoever is quicker has the descriptor now; then there is no reserve, and clients wait.
  if (!accepted) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

void HttpServer::take(UniqueFd socket) {
  const int one = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  bool taken = false;
  {
    const std::lock_guard lock(mutex_);
    const bool needs_thread = idle_ <= waiting_.size();
    taken = !needs_thread || threads_.size() < kMaxThreads;
    if (taken) {
      waiting_.push_back(std::move(socket));
      if (needs_thread) start_thread();
    }
  }
  if (taken) {
    arrived_.notify_one();
    return;
  }
  turn_away(socket);  // NOLINT: not moved
}

/// With mutex_ held. Where no thread can be had, those that run take the connection later.
void HttpServer::start_thread() {
  try {
    threads_.emplace_back([this](std::stop_token stop) { serve_queue(stop); });
  } catch (const std::system_error&) {
    log_.write(LogLevel::error, "no_thread_left", {{"threads", threads_.size()}});
  }
}

void HttpServer::serve_queue(std::stop_token stop) {
  while (true) {
    std::unique_lock lock(mutex_);
    ++idle_;
    const bool work = arrived_.wait(lock, stop, [this] { return !waiting_.empty(); });
    --idle_;
    if (!work) return;
    UniqueFd socket = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    Connection connection(std::move(socket), limits_, stopping_.descriptor());
    serve_connection(connection, application_, log_, limits_);
  }
}

}  // namespace fairway
