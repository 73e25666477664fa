#include "server/fairwayd/http/waiting_room.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <utility>

#include <sys/epoll.h>
#include <sys/socket.h>

#include "server/fairwayd/http/http_message.h"
#include "server/os/file.h"

namespace fairway {
namespace {

/// Of a head, as much as is looked at.
constexpr std::size_t kLook = 4096;
constexpr std::size_t kMaxWaste = std::size_t{4} << 20;
constexpr std::size_t kEvents = 64;
constexpr auto kNoGuest = static_cast<void*>(nullptr);

}  // namespace

Result<std::unique_ptr<WaitingRoom>> WaitingRoom::create(const WaitingRoomLimits& limits,
                                                         Admit admit) {
  UniqueFd poller(::epoll_create1(EPOLL_CLOEXEC));
  if (!poller) {
    return Error{ErrorCode::unavailable, system_sentence("make a poll descriptor", errno)};
  }
  auto woken = EventFlag::create();
  if (!woken) return woken.error();
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.ptr = kNoGuest;
  if (::epoll_ctl(poller.get(), EPOLL_CTL_ADD, woken->descriptor(), &event) != 0) {
    return Error{ErrorCode::unavailable, system_sentence("watch a descriptor", errno)};
  }
  return std::unique_ptr<WaitingRoom>(
      new WaitingRoom(limits, std::move(admit), std::move(poller), *std::move(woken)));
}

WaitingRoom::WaitingRoom(const WaitingRoomLimits& limits, Admit admit, UniqueFd poller,
                         EventFlag woken)
    : limits_(limits),
      admit_(std::move(admit)),
      poller_(std::move(poller)),
      woken_(std::move(woken)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

WaitingRoom::~WaitingRoom() {
  thread_.request_stop();
  woken_.raise();
}

void WaitingRoom::enter(Visitor visitor) {
  {
    const std::lock_guard lock(mutex_);
    arrivals_.push_back(std::move(visitor));
  }
  woken_.raise();
}

void WaitingRoom::run(const std::stop_token& stop) {
  std::array<epoll_event, kEvents> events;
  while (!stop.stop_requested()) {
    const int count = ::epoll_wait(poller_.get(), events.data(), static_cast<int>(events.size()),
                                   next_deadline(Clock::now()));
    for (int i = 0; i < count; ++i) {
      auto* guest = static_cast<Guest*>(events.at(static_cast<std::size_t>(i)).data.ptr);
      if (guest != nullptr) hear(*guest);
    }
    // Only after the events, which point at guests that are there.
    see_off(Clock::now());
    let_in();
  }
}

void WaitingRoom::let_in() {
  std::vector<Visitor> arrivals;
  {
    const std::lock_guard lock(mutex_);
    woken_.lower();
    arrivals.swap(arrivals_);
  }
  for (Visitor& visitor : arrivals) {
    if (listening_.size() + refused_.size() >= limits_.guests) {
      (refused_.empty() ? listening_ : refused_).pop_front();
    }
    listening_.push_back({std::move(visitor), Clock::now() + limits_.patience});
    if (!watch(listening_.back())) refuse(listening_.back());
  }
}

bool WaitingRoom::watch(Guest& guest) {
  epoll_event event{};
  event.events = EPOLLIN | EPOLLRDHUP | EPOLLET;  // once for what comes, also if it stays unread
  event.data.ptr = &guest;
  return ::epoll_ctl(poller_.get(), EPOLL_CTL_ADD, guest.visitor.socket.get(), &event) == 0;
}

void WaitingRoom::hear(Guest& guest) {
  if (!guest.visitor.socket) return;
  guest.is_refused ? waste(guest) : listen(guest);
}

/// Looks at what has come, and leaves it in the socket.
void WaitingRoom::listen(Guest& guest) {
  std::array<char, kLook> space;
  const int socket = guest.visitor.socket.get();
  const ssize_t got = ::recv(socket, space.data(), space.size(), MSG_PEEK | MSG_DONTWAIT);
  if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (got <= 0) return guest.visitor.socket.reset();
  const std::string_view head(space.data(), static_cast<std::size_t>(got));
  if (head.find("\r\n\r\n") == std::string_view::npos && head.size() < space.size()) return;
  const std::string_view line = head.substr(0, head.find("\r\n"));
  const std::string_view method = line.substr(0, line.find(' '));
  const std::string_view rest = line.substr(std::min(method.size() + 1, line.size()));
  // Whoever takes the socket may close it at once: it is no longer watched by then.
  ::epoll_ctl(poller_.get(), EPOLL_CTL_DEL, socket, nullptr);
  if (admit_(guest.visitor, method, rest.substr(0, rest.find(' ')))) return;
  refuse(guest);
  watch(guest);
}

/// Answers, and reads on for a while, because closing a socket over unread bytes takes the answer
/// back.
void WaitingRoom::refuse(Guest& guest) {
  const std::string text = refusal_message(
      {ErrorCode::unavailable, "The server has more clients than it can serve: try later."});
  ::send(guest.visitor.socket.get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  ::shutdown(guest.visitor.socket.get(), SHUT_WR);
  guest.is_refused = true;
  guest.until = Clock::now() + limits_.linger;
  const auto here = std::find_if(listening_.begin(), listening_.end(),
                                 [&](const Guest& other) { return &other == &guest; });
  refused_.splice(refused_.end(), listening_, here);
  waste(guest);
}

void WaitingRoom::waste(Guest& guest) {
  std::array<char, 16384> space;
  while (guest.wasted < kMaxWaste) {
    const ssize_t got =
        ::recv(guest.visitor.socket.get(), space.data(), space.size(), MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (got <= 0) break;
    guest.wasted += static_cast<std::size_t>(got);
  }
  guest.visitor.socket.reset();
}

void WaitingRoom::see_off(Clock::time_point now) {
  const auto is_gone = [](const Guest& guest) { return !guest.visitor.socket; };
  while (!listening_.empty() && listening_.front().until <= now) {
    Guest& guest = listening_.front();
    guest.visitor.socket ? refuse(guest) : listening_.pop_front();
  }
  listening_.remove_if(is_gone);
  while (!refused_.empty() && refused_.front().until <= now) refused_.pop_front();
  refused_.remove_if(is_gone);
}

/// Milliseconds until the next guest's time is over; -1 where there is none.
int WaitingRoom::next_deadline(Clock::time_point now) const {
  auto next = Clock::time_point::max();
  for (const Guests* guests : {&listening_, &refused_}) {
    if (!guests->empty()) next = std::min(next, guests->front().until);
  }
  if (next == Clock::time_point::max()) return -1;
  return static_cast<int>(
      std::max<std::int64_t>(std::chrono::ceil<std::chrono::milliseconds>(next - now).count(), 0));
}

}  // namespace fairway
