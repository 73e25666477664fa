#include "server/fairwayd/api/rate_limit.h"

#include <catch2/catch.hpp>

#include "server/fairwayd/uploads/memory_estimate.h"

using namespace fairway;
using namespace std::chrono_literals;

TEST_CASE("a tenant submits as often as the rate says, and others do not matter") {
  RateLimit limit(6);
  const auto start = RateLimit::Clock::now();
  for (std::uint64_t left = 6; left-- > 0;) {
    const auto verdict = limit.take("a", start);
    CHECK(verdict.allowed);
    CHECK(verdict.left == left);
  }
  const auto refused = limit.take("a", start);
  CHECK_FALSE(refused.allowed);
  CHECK(refused.reset == 10s);
  CHECK(limit.take("b", start).allowed);
  CHECK_FALSE(limit.take("a", start + 9s).allowed);
  CHECK(limit.take("a", start + 10s).allowed);
  CHECK_FALSE(limit.take("a", start + 10s).allowed);
}

TEST_CASE("a bucket never holds more than a minute's submits") {
  RateLimit limit(2);
  const auto start = RateLimit::Clock::now();
  CHECK(limit.take("a", start).allowed);
  const auto later = start + 1h;
  CHECK(limit.take("a", later).allowed);
  CHECK(limit.take("a", later).allowed);
  CHECK_FALSE(limit.take("a", later).allowed);
}

TEST_CASE("a rate of nought is no limit") {
  RateLimit limit(0);
  CHECK_FALSE(limit.is_on());
  for (int i = 0; i < 1000; ++i) CHECK(limit.take("a").allowed);
}

TEST_CASE("a job needs at least as much memory as its file, and compressed meshes more") {
  CHECK(least_memory(Format::glb, 1000) == 1000);
  CHECK(least_memory(Format::drc, 1000) > least_memory(Format::ply, 1000));
  CHECK(least_memory(Format::ply, 1000) > 1000);
}
