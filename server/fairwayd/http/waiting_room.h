#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/result.h"
#include "server/os/event_flag.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// A connection, and whom it counts for (origin_of()).
struct Visitor {
  UniqueFd socket;
  std::string origin;
};

/// How many a waiting room holds, and for how long.
struct WaitingRoomLimits {
  std::size_t guests = 1024;
  std::chrono::milliseconds patience{1000};  ///< for a whole head
  std::chrono::milliseconds linger{1000};    ///< for what a client sends after its refusal
};

/// Connections that no thread is free for. One thread watches all of them and waits for none: only
/// who has sent a whole head, or 4 KiB of it, is admitted or refused (503); who does not is refused
/// in the end. Where the room is full the oldest guest goes.
class WaitingRoom {
 public:
  /// Takes a socket, of which nothing has been read; method and path as they came. False: there is
  /// no place for it, and it is left where it was. Called in the room's thread; must not wait.
  using Admit =
      std::function<bool(Visitor& visitor, std::string_view method, std::string_view path)>;

  /// Errors: unavailable (no descriptor left).
  static Result<std::unique_ptr<WaitingRoom>> create(const WaitingRoomLimits& limits, Admit admit);
  ~WaitingRoom();
  WaitingRoom(const WaitingRoom&) = delete;
  WaitingRoom& operator=(const WaitingRoom&) = delete;

  /// From any thread.
  void enter(Visitor visitor);

 private:
  using Clock = std::chrono::steady_clock;
  struct Guest {
    Visitor visitor;
    Clock::time_point until;
    bool is_refused = false;
    std::size_t wasted = 0;  ///< bytes read after the refusal
  };
  using Guests = std::list<Guest>;

  WaitingRoom(const WaitingRoomLimits& limits, Admit admit, UniqueFd poller, EventFlag woken);

  void run(const std::stop_token& stop);
  void let_in();
  bool watch(Guest& guest);
  void hear(Guest& guest);
  void listen(Guest& guest);
  void waste(Guest& guest);
  void refuse(Guest& guest);
  void see_off(Clock::time_point now);
  int next_deadline(Clock::time_point now) const;

  const WaitingRoomLimits limits_;
  const Admit admit_;
  const UniqueFd poller_;  ///< an epoll descriptor
  const EventFlag woken_;

  std::mutex mutex_;
  std::vector<Visitor> arrivals_;  ///< guarded by mutex_

  // Of the room's thread. Both in the order of their deadlines.
  Guests listening_;
  Guests refused_;
  std::jthread thread_;
};

}  // namespace fairway
