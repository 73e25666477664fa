// Many jobs, many connections.
#include <chrono>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <sys/socket.h>

#include "tests/chaos/arena.h"
#include "tests/chaos/crowd.h"
#include "tests/chaos/scenarios.h"
#include "tests/service/support/job_follower.h"

namespace fairway::chaos {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kJobs = 1000;
constexpr double kPatience = 60000.0;
constexpr double kReadyBound = 2000.0;
constexpr double kRequeueBound = 2000.0;
constexpr double kLivezBound = 100.0;
constexpr std::size_t kHeld = 200;
constexpr int kLookups = 100;

double until_ready(const Arena& arena) {
  while (arena.client().get("/readyz").status != 200) {
    expect(arena.milliseconds_up() < kPatience, "the service is not ready for a minute");
    std::this_thread::sleep_for(milliseconds(2));
  }
  return arena.milliseconds_up();
}

/// Connections that send a byte now and then: half of them within a head, half within a mesh.
class SlowClients {
 public:
  SlowClients(std::uint16_t port, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      sockets_.push_back(test::connect_to(port, std::chrono::seconds(1)));
      send(i, i % 2 == 0 ? kPartOfHead : kHead);
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { drip(stop); });
  }

 private:
  static constexpr std::string_view kPartOfHead = "POST /v1/jobs HTTP/1.1\r\nHost: slow\r\nX-A: ";
  static constexpr std::string_view kHead =
      "POST /v1/jobs HTTP/1.1\r\nHost: slow\r\nContent-Type: model/gltf-binary\r\n"
      "Content-Length: 100000\r\n\r\ng";

  /// A server that has lost its patience may close the connection.
  void send(std::size_t i, std::string_view bytes) {
    ::send(sockets_.at(i).get(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }

  void drip(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      for (std::size_t i = 0; i < sockets_.size(); ++i) send(i, "l");
      std::this_thread::sleep_for(milliseconds(100));
    }
  }

  std::vector<UniqueFd> sockets_;
  std::jthread thread_;
};

}  // namespace

void restart_with_queue(Trials& trials, Workshop& workshop, std::size_t count) {
  Arena arena(trials, {"--workers", "1", "--queue", "2000"});
  const std::vector<Work> kinds = kinds_of(workshop);
  const std::size_t jobs = trials.scaled(kJobs);
  std::string first;
  for (std::size_t i = 0; i < count; ++i) {
    trials.run(fmt::format("#{} with {} queued jobs", i, jobs), [&] {
      if (first.empty()) {
        arena.start();
        const Work work = workshop.endless();
        first = test::submit(arena.client(), work.mesh, work.parameters);
        test::wait_until_busy(arena.client(), first);
        const Told told = Crowd(arena.client(), kinds, jobs).ask(kClients, kWorkOfItsOwn);
        expect_accepted(told, jobs);
        for (const auto& [id, sha256] : told.accepted) arena.promise(id, sha256);
      }
      arena.kill();
      arena.start();
      trials.measure("restart with queued jobs until /readyz", until_ready(arena), "ms",
                     kReadyBound);
      const std::string id = first.substr(path_of("").size());
      trials.measure("restart with queued jobs until orphan runs", arena.until_running_again(id),
                     "ms", kRequeueBound);
    });
  }
  trials.run("all of them end", [&] {
    expect(!first.empty(), "there is no queue");
    expect(arena.client().remove(first).status == 200, "the job in front cannot be deleted");
    arena.expect_promises_kept();
  });
}

void hold_connections(Trials& trials, Workshop& workshop, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    trials.run(fmt::format("{} idle and {} slow ones", kHeld, kHeld), [&] {
      Arena arena(trials);
      arena.start();
      std::vector<UniqueFd> idle;
      for (std::size_t k = 0; k < kHeld; ++k) {
        idle.push_back(test::connect_to(arena.service().port(), std::chrono::seconds(1)));
      }
      std::optional<SlowClients> slow(std::in_place, arena.service().port(), kHeld);
      for (int k = 0; k < kLookups; ++k) {
        const auto began = steady_clock::now();
        expect(arena.client().get("/livez").status == 200, "/livez was not answered");
        trials.measure("/livez beside 400 held connections", milliseconds_since(began), "ms",
                       kLivezBound);
        std::this_thread::sleep_for(milliseconds(10));
      }
      const auto began = steady_clock::now();
      arena.submit(workshop.small());
      arena.expect_results();
      trials.measure("job beside 400 held connections", milliseconds_since(began), "ms");
      slow.reset();
      arena.expect_clean_disk();
    });
  }
}

}  // namespace fairway::chaos
