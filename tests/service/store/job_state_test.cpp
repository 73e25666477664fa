#include "server/fairwayd/store/job_state.h"

#include <array>
#include <set>
#include <utility>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

using enum JobState;
constexpr std::array kAll = {queued, running, succeeded, failed, canceled, expired};

}  // namespace

TEST_CASE("exactly the documented moves between states are allowed") {
  const std::set<std::pair<JobState, JobState>> documented = {
      {queued, running},   {queued, canceled}, {running, succeeded}, {running, failed},
      {running, canceled}, {running, queued},  {succeeded, expired}, {failed, expired},
      {canceled, expired}, {failed, queued},   {canceled, queued}};
  for (const JobState from : kAll) {
    for (const JobState to : kAll) {
      CAPTURE(name_of(from), name_of(to));
      CHECK(may_follow(from, to) == documented.contains({from, to}));
    }
  }
}

TEST_CASE("nothing leads back from a result or from what has expired") {
  for (const JobState from : {succeeded, expired}) {
    for (const JobState to : kAll) {
      if (!is_final(to)) CHECK_FALSE(may_follow(from, to));
    }
  }
}

TEST_CASE("a state's name reads back as the state") {
  for (const JobState state : kAll) CHECK(job_state_of_name(name_of(state)) == state);
  CHECK_FALSE(job_state_of_name("done"));
}
