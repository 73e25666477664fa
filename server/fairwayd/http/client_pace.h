#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace fairway {

/// What a connection waits for its client to do.
enum class ClientPhase : std::uint8_t {
  busy,    ///< nothing: the server is at work
  idle,    ///< begin a request, or hang up
  head,    ///< end the head of a request
  body,    ///< send more of a body
  answer,  ///< read more of an answer
};

/// Keeps the time that a client makes its connection wait, of which its bytes excuse some: who
/// sends or reads below a least rate runs out of patience, however evenly he drips. For one thread,
/// but for waiting().
class ClientPace {
 public:
  using Clock = std::chrono::steady_clock;

  /// `least_rate`: bytes that excuse a second; not 0.
  explicit ClientPace(std::uint64_t least_rate) : least_rate_(least_rate) {}

  /// Forgets what was.
  void restart() { lag_ = {}; }

  /// A wait begins. Returns when a client with this much patience left has used it up.
  Clock::time_point begin(ClientPhase phase, Clock::duration patience, Clock::time_point now) {
    from_ = now;
    owed_since_ = (now - lag_).time_since_epoch().count();
    phase_ = phase;
    return now + (patience - lag_);
  }

  void end(Clock::time_point now) {
    phase_ = ClientPhase::busy;
    lag_ += now - from_;
  }

  /// Bytes came or went.
  void excuse(std::size_t bytes) {
    constexpr std::uint64_t kFull = 3600;  // seconds; keeps the product small
    const auto seconds = static_cast<std::uint64_t>(bytes) / least_rate_;
    const auto rest = static_cast<std::uint64_t>(bytes) % least_rate_;
    const std::chrono::nanoseconds excused =
        std::chrono::seconds(seconds < kFull ? seconds : kFull) +
        std::chrono::nanoseconds(rest * 1'000'000'000U / least_rate_);
    lag_ = lag_ > excused ? lag_ - excused : Clock::duration{};
  }

  struct Waiting {
    ClientPhase phase;
    Clock::duration lag;  ///< of waiting that no bytes excuse
  };
  /// From any thread; the two may be of different moments.
  Waiting waiting(Clock::time_point now) const {
    return {phase_, now.time_since_epoch() - Clock::duration(owed_since_)};
  }

 private:
  const std::uint64_t least_rate_;
  Clock::duration lag_{};
  Clock::time_point from_;
  std::atomic<ClientPhase> phase_ = ClientPhase::busy;
  std::atomic<Clock::rep> owed_since_ = 0;
};

}  // namespace fairway
