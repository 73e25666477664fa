#include "server/fairway/progress_pace.h"

#include <catch2/catch.hpp>

namespace fairway::test {
namespace {

using std::chrono::milliseconds;

const ProgressPace::Clock::time_point kStart{std::chrono::hours(1)};

}  // namespace

TEST_CASE("every stage of a job is told, however soon it comes") {
  ProgressPace pace;
  for (const char* stage : {"decode", "topology", "flow", "curvature", "topology"}) {
    CHECK(pace.admits({stage, 0, 0, 0.0}, kStart));
  }
}

TEST_CASE("steps are told at a pace, counted from the last one told") {
  ProgressPace pace;
  CHECK(pace.admits({"flow", 0, 9, 0.1}, kStart));
  CHECK_FALSE(pace.admits({"flow", 1, 9, 0.2}, kStart + milliseconds(19)));
  CHECK(pace.admits({"flow", 2, 9, 0.3}, kStart + milliseconds(20)));
  CHECK_FALSE(pace.admits({"flow", 3, 9, 0.4}, kStart + milliseconds(39)));
  CHECK(pace.admits({"flow", 4, 9, 0.5}, kStart + milliseconds(60)));
}

}  // namespace fairway::test
