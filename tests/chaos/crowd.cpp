#include "tests/chaos/crowd.h"

#include <chrono>
#include <thread>

#include <fmt/format.h>

#include "tests/chaos/trials.h"

namespace fairway::chaos {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kKinds = 20;
constexpr milliseconds kBeforeNextTry{20};

}  // namespace

std::vector<Work> kinds_of(Workshop& workshop) {
  std::vector<Work> kinds;
  for (std::size_t i = 0; i < kKinds; ++i) kinds.push_back(workshop.small());
  return kinds;
}

Told Crowd::ask(std::size_t clients, const test::HttpClient::Headers& headers) {
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < clients; ++i) {
      threads.emplace_back([this, &headers] { serve_client(headers); });
    }
  }
  return std::move(told_);
}

void Crowd::serve_client(const test::HttpClient::Headers& headers) {
  for (std::size_t job = next_++; job < jobs_; job = next_++) {
    while (!offer(kinds_.at(job % kinds_.size()), headers)) {
      std::this_thread::sleep_for(kBeforeNextTry);
    }
  }
}

/// False: refused, and to be offered again.
bool Crowd::offer(const Work& work, const test::HttpClient::Headers& headers) {
  const auto began = steady_clock::now();
  const test::Answer answer =
      client_.post("/v1/jobs?params=" + test::percent_encoded(work.parameters), work.mesh,
                   "model/gltf-binary", headers);
  const double took = milliseconds_since(began);
  const std::lock_guard lock(mutex_);
  if (answer.status == 429) {
    told_.refusals.push_back(took);
    return false;
  }
  const auto job = parse_json(answer.body);
  if (answer.status == 202 && job) {
    told_.accepted.emplace((*job)["id"].get<std::string>(), work.sha256);
  } else {
    told_.others.push_back(answer.status);
  }
  return true;
}

void expect_accepted(const Told& told, std::size_t jobs) {
  for (const int status : told.others) throw Broken(fmt::format("a job was answered {}", status));
  expect(told.accepted.size() == jobs,
         fmt::format("{} of {} jobs have an id of their own", told.accepted.size(), jobs));
}

}  // namespace fairway::chaos
