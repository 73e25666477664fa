#include "server/fairwayd/http/http_server.h"

#include <algorithm>
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

/// Bytes of an answer that the system keeps for a client who does not read. Without a limit it is
/// 4 MiB each, and a crowd of them stalls all of its TCP.
constexpr int kUnsent = 256 * 1024;
/// Vital requests that are being answered or wait for it.
constexpr std::size_t kMaxVital = 1024;
/// A vital request's head has come already, and nothing should follow it.
constexpr std::chrono::milliseconds kVitalPatience{250};
constexpr std::chrono::milliseconds kVitalLinger{20};
constexpr std::chrono::minutes kTellFull{1};
/// Of one who is turned away: milliseconds of silence that are waited for, pieces that are read.
constexpr int kQuiet = 20;
constexpr int kMostUnread = 64;

UniqueFd spare_descriptor() {
  return UniqueFd(::open("/dev/null", O_RDONLY | O_CLOEXEC));
}

/// Tells a client in one piece that there is no place. What it sends is taken from the socket for a
/// moment, because closing it over that would take the answer back.
void turn_away(const UniqueFd& socket) {
  const std::string busy = refusal_message({ErrorCode::unavailable, "Too many connections."});
  ::send(socket.get(), busy.data(), busy.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  ::shutdown(socket.get(), SHUT_WR);
  std::array<char, 16384> unread;
  for (int i = 0; i < kMostUnread; ++i) {
    pollfd more{socket.get(), POLLIN, 0};
    if (::poll(&more, 1, kQuiet) != 1) return;
    if (::recv(socket.get(), unread.data(), unread.size(), MSG_DONTWAIT) <= 0) return;
  }
}

}  // namespace

HttpServer::HttpServer(Listener listener, HttpApplication& application, const Log& log,
                       const ConnectionLimits& limits, const EventFlag& stopping,
                       const ServerCapacity& capacity)
    : limits_(limits),
      capacity_(capacity),
      listener_(std::move(listener)),
      application_(application),
      log_(log),
      stopping_(stopping) {}

HttpServer::~HttpServer() {
  if (acceptor_.joinable()) acceptor_.join();
  waiting_room_.reset();
  std::vector<std::jthread> threads;
  {
    const std::lock_guard lock(mutex_);
    for (Lane* lane : {&lane_, &vital_}) {
      lane->waiting.clear();
      for (std::jthread& thread : lane->threads) threads.push_back(std::move(thread));
      lane->threads.clear();
    }
  }
  for (std::jthread& thread : threads) thread.request_stop();
}

void HttpServer::start() {
  reserve_ = spare_descriptor();
  auto room = WaitingRoom::create(
      {}, [this](Visitor& visitor, std::string_view method, std::string_view path) {
        return admit(visitor, method, path);
      });
  if (room) {
    waiting_room_ = *std::move(room);
  } else {
    log_.write(LogLevel::error, "no_waiting_room", {{"reason", room.error().message}});
  }
  acceptor_ = std::jthread([this] { accept_all(); });
}

void HttpServer::accept_all() {
  while (true) {
    std::array<pollfd, 2> entries{
        {{listener_.socket.get(), POLLIN, 0}, {stopping_.descriptor(), POLLIN, 0}}};
    ::poll(entries.data(), entries.size(), -1);
    if (entries[1].revents != 0) break;
    sockaddr_storage peer{};
    socklen_t size = sizeof peer;
    UniqueFd socket(
        ::accept4(listener_.socket.get(), reinterpret_cast<sockaddr*>(&peer), &size, SOCK_CLOEXEC));
    if (socket) {
      tell_accepting(true, 0);
      take({std::move(socket), origin_of(peer)});
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

void HttpServer::take(Visitor arrival) {
  const int one = 1;
  ::setsockopt(arrival.socket.get(), IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  ::setsockopt(arrival.socket.get(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &kUnsent, sizeof kUnsent);
  {
    const std::lock_guard lock(mutex_);
    if (lane_.open < capacity_.connections) return enter(lane_, std::move(arrival));
  }
  tell_full();
  if (waiting_room_) return waiting_room_->enter(std::move(arrival));
  turn_away(arrival.socket);
}

/// Once in a while.
void HttpServer::tell_full() {
  const auto now = std::chrono::steady_clock::now();
  if (told_full_ && now - *told_full_ < kTellFull) return;
  told_full_ = now;
  log_.write(LogLevel::warning, "connections_full", {{"most", capacity_.connections}});
}

/// A connection that has asked, in the waiting room.
bool HttpServer::admit(Visitor& visitor, std::string_view method, std::string_view path) {
  const std::lock_guard lock(mutex_);
  const bool is_vital = application_.is_vital(method, path);
  const bool has_place =
      is_vital ? vital_.open < kMaxVital
               : lane_.open < capacity_.connections || roster_.make_room(visitor.origin);
  if (has_place) enter(is_vital ? vital_ : lane_, std::move(visitor));
  return has_place;
}

/// With mutex_ held.
void HttpServer::enter(Lane& lane, Visitor arrival) {
  const std::size_t most = &lane == &vital_ ? capacity_.vital : capacity_.connections;
  const bool needs_thread = lane.idle <= lane.waiting.size() && lane.threads.size() < most;
  lane.waiting.push_back(std::move(arrival));
  ++lane.open;
  if (needs_thread) start_thread(lane);
  lane.arrived.notify_one();
}

/// With mutex_ held. Where no thread can be had, those that run take the connection later.
void HttpServer::start_thread(Lane& lane) {
  try {
    lane.threads.emplace_back(
        [this, &lane](const std::stop_token& stop) { serve_queue(lane, stop); });
  } catch (const std::system_error&) {
    log_.write(LogLevel::error, "no_thread_left", {{"threads", lane.threads.size()}});
  }
}

void HttpServer::serve_queue(Lane& lane, const std::stop_token& stop) {
  const bool is_vital = &lane == &vital_;
  ConnectionLimits limits = limits_;
  if (is_vital) {
    limits.idle = limits.head = limits.stall = std::min(limits.head, kVitalPatience);
    limits.linger = kVitalLinger;
  }
  while (true) {
    std::unique_lock lock(mutex_);
    ++lane.idle;
    const bool work = lane.arrived.wait(lock, stop, [&lane] { return !lane.waiting.empty(); });
    --lane.idle;
    if (!work) return;
    Visitor arrival = std::move(lane.waiting.front());
    lane.waiting.pop_front();
    lock.unlock();
    {
      Connection connection(std::move(arrival.socket), limits, stopping_.descriptor());
      if (is_vital) {
        serve_connection(connection, application_, log_, limits, 1);
      } else {
        const ConnectionRoster::Entry entry(roster_, connection, std::move(arrival.origin));
        serve_connection(connection, application_, log_, limits);
      }
    }
    lock.lock();
    --lane.open;
  }
}

}  // namespace fairway
