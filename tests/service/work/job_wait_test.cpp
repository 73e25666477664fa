#include "server/fairwayd/work/job_wait.h"

#include <thread>

#include <catch2/catch.hpp>

#include "server/fairwayd/api/watch_limit.h"
#include "tests/service/support/job_fixture.h"

using namespace fairway;
using namespace std::chrono_literals;

namespace {

constexpr auto kLong = 120s;

Waited wait(test::JobFixture& f, JobState state, std::chrono::milliseconds time = kLong) {
  const auto waited = wait_for_job(f.watch(), f.number(), std::chrono::steady_clock::now() + time,
                                   [state](const Job& job) { return job.state == state; });
  REQUIRE(waited);
  return *waited;
}

}  // namespace

TEST_CASE("a wait for what is there already ends at once, whatever else is true") {
  test::JobFixture f;
  f.client_is_there = false;
  f.stop.request_stop();
  const Waited waited = wait(f, JobState::queued, 0ms);
  CHECK(waited.end == WaitEnd::reached);
  CHECK(waited.job.state == JobState::queued);
}

TEST_CASE("a wait ends with the time, the client or the server") {
  test::JobFixture f;
  CHECK(wait(f, JobState::running, 0ms).end == WaitEnd::time_up);
  CHECK(wait(f, JobState::running, 30ms).end == WaitEnd::time_up);
  f.client_is_there = false;
  CHECK(wait(f, JobState::running).end == WaitEnd::client_gone);
  f.client_is_there = true;
  f.stop.request_stop();
  CHECK(wait(f, JobState::running).end == WaitEnd::stopping);
}

TEST_CASE("a wait ends when the job has changed, announced or not") {
  test::JobFixture f;
  const bool announced = GENERATE(true, false);
  std::jthread other([&] {
    std::this_thread::sleep_for(50ms);
    f.start();
    if (announced) f.board.announce();
  });
  const Waited waited = wait(f, JobState::running);
  CHECK(waited.end == WaitEnd::reached);
  CHECK(waited.job.state == JobState::running);
}

TEST_CASE("the time is up although others' jobs keep changing") {
  test::JobFixture f;
  std::jthread others([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      f.board.announce();
      std::this_thread::sleep_for(1ms);
    }
  });
  CHECK(wait(f, JobState::running, 100ms).end == WaitEnd::time_up);
}

TEST_CASE("a wait for a job that does not exist is an error") {
  test::JobFixture f;
  const auto waited =
      wait_for_job(f.watch(), f.number() + 1, std::chrono::steady_clock::now() + kLong,
                   [](const Job&) { return false; });
  REQUIRE_FALSE(waited);
  CHECK(waited.error().code == ErrorCode::not_found);
}

TEST_CASE("a place to watch comes back when it is given up") {
  WatchLimit limit(2);
  auto first = limit.take();
  const auto second = limit.take();
  CHECK(first);
  CHECK(second);
  CHECK_FALSE(limit.take());
  CHECK_FALSE(limit.take());
  auto copy = first;
  first.reset();
  CHECK_FALSE(limit.take());
  copy.reset();
  CHECK(limit.take());
}
