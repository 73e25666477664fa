// Many clients at once, none of which does anything forbidden.
#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/hostile/attacks.h"

namespace fairway::hostile {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kSamples = 200;
constexpr double kFreshLivez = 100.0;
constexpr double kPercentile = 0.99;
/// More than the server has places.
constexpr std::size_t kCrowd = 600;
/// MiB; half of what a service may take by itself.
constexpr long kMostInSockets = 256;

/// Clients that send a little now and then.
class Drip {
 public:
  Drip(std::uint16_t port, std::size_t count, const char* from, const std::string& first,
       const std::string& drop, milliseconds every)
      : drop_(drop), every_(every) {
    for (std::size_t i = 0; i < count; ++i) {
      wires_.emplace_back(port, from);
      wires_.back().send_some(first);
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { drip(stop); });
  }

 private:
  void drip(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      for (Wire& wire : wires_) wire.send_some(drop_);
      std::this_thread::sleep_for(every_);
    }
  }

  const std::string drop_;
  const milliseconds every_;
  std::vector<Wire> wires_;
  std::jthread thread_;
};

std::string slow_body() {
  return upload_head({"Content-Length: 16000000"}) + "g";
}

std::string slow_head() {
  return "POST /v1/jobs HTTP/1.1\r\nHost: slow\r\nX-A: ";
}

/// Fresh connections to /livez, one after the other.
void expect_fresh_livez(Field& field, const std::string& beside) {
  std::vector<double> times;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const auto began = steady_clock::now();
    expect(field.target().client().get("/livez").status == 200,
           "/livez was refused beside " + beside);
    times.push_back(milliseconds_since(began));
    std::this_thread::sleep_for(milliseconds(5));
  }
  const double p99 = quantile(times, kPercentile);
  field.tell(fmt::format("fresh /livez beside {}: p99 {:.1f} ms", beside, p99));
  expect(p99 < kFreshLivez * field.patience(), fmt::format("/livez took {:.0f} ms", p99));
}

void slowloris(Field& field) {
  const Drip heads(field.port(), 100, "127.0.0.1", slow_head(), "l", milliseconds(100));
  const Drip bodies(field.port(), 100, "127.0.0.1", slow_body(), "l", milliseconds(100));
  expect_fresh_livez(field, "200 slow connections");
  field.expect_serving();
}

/// More slow ones than there are places: who is slowest gives way.
void slow_crowd(Field& field) {
  const Drip heads(field.port(), kCrowd / 2, "127.0.0.1", slow_head(), "l", milliseconds(200));
  const Drip bodies(field.port(), kCrowd / 2, "127.0.0.1", slow_body(), "l", milliseconds(200));
  std::this_thread::sleep_for(milliseconds(2000));
  for (int i = 0; i < 5; ++i) field.expect_serving();
  expect_fresh_livez(field, fmt::format("{} slow connections", kCrowd));
}

/// A client that drips is let go, although it never stops.
void drip_ends(Field& field) {
  Wire body(field.port());
  body.send_some(slow_body());
  const auto began = steady_clock::now();
  while (answers_in(body.received()).whole.empty() && !body.is_closed() &&
         milliseconds_since(began) < 60000.0 * field.patience()) {
    body.send("l", milliseconds(100));
    body.read_answer(milliseconds(200));
  }
  field.expect_refused(body, "408");
  field.tell(fmt::format("a dripped body ends after {:.0f} s", milliseconds_since(began) / 1000.0));
}

void idle_keep_alives(Field& field) {
  std::vector<Wire> idle;
  for (std::size_t i = 0; i < kCrowd; ++i) {
    idle.emplace_back(field.port());
    if (i % 2 == 0) idle.back().send_some(head_of("GET", "/livez"));
  }
  std::this_thread::sleep_for(milliseconds(300));  // who has just come is not idle yet
  field.expect_serving();
  expect_fresh_livez(field, fmt::format("{} idle connections", kCrowd));
}

/// One address sends just fast enough in all places: others are served all the same.
void one_address(Field& field) {
  const Drip greedy(field.port(), kCrowd, "127.0.0.2", slow_body(), std::string(1024, 'x'),
                    milliseconds(250));
  std::this_thread::sleep_for(milliseconds(2500));
  for (int i = 0; i < 10; ++i) field.expect_serving();
  expect_fresh_livez(field, fmt::format("{} fast connections of another address", kCrowd));
}

/// MiB that the system keeps for all TCP of this machine.
long socket_memory() {
  std::ifstream all("/proc/net/sockstat");
  for (std::string line; std::getline(all, line);) {
    const std::size_t at = line.find(" mem ");
    if (line.starts_with("TCP:") && at != std::string::npos) {
      return std::atol(line.c_str() + at + 5) * ::sysconf(_SC_PAGESIZE) / (1024 * 1024);
    }
  }
  throw Broken("the system does not tell the memory of its sockets");
}

/// Clients that ask for a large result and do not read it.
void deaf_clients(Field& field) {
  const std::string result = field.large_result();
  std::vector<Wire> deaf;
  const int small = 4096;
  for (std::size_t i = 0; i < kCrowd; ++i) {
    deaf.emplace_back(field.port());
    ::setsockopt(deaf.back().descriptor(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    deaf.back().send_some(head_of("GET", result));
  }
  std::this_thread::sleep_for(milliseconds(2000));
  const long buffered = socket_memory();
  field.tell(fmt::format("{} MiB in sockets", buffered));
  expect(buffered < kMostInSockets, fmt::format("{} MiB in sockets", buffered));
  for (int i = 0; i < 5; ++i) field.expect_serving();
  expect_fresh_livez(field, fmt::format("{} deaf clients", kCrowd));
}

/// Connections that are open, this question's own among them.
int open_connections(const Field& field) {
  constexpr std::string_view kGauge = "\nfairway_http_connections ";
  const std::string text = test::HttpClient(field.port()).get("/metrics").body;
  const std::size_t at = text.find(kGauge);
  expect(at != std::string::npos, "/metrics does not count connections");
  return std::atoi(text.c_str() + at + kGauge.size());
}

/// Who reads a little now and then does not hold a place for good.
void slow_reader_ends(Field& field) {
  const std::string result = field.large_result();
  Wire slow(field.port());
  const int small = 4096;
  ::setsockopt(slow.descriptor(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  slow.send_some(head_of("GET", result));
  std::array<char, 64> few;
  expect(::recv(slow.descriptor(), few.data(), few.size(), 0) > 0, "the result does not come");
  const auto began = steady_clock::now();
  while (open_connections(field) > 1) {
    expect(milliseconds_since(began) < 60000.0 * field.patience(),
           "a client that reads 64 bytes in 0.2 s is served for good");
    ::recv(slow.descriptor(), few.data(), few.size(), MSG_DONTWAIT);
    std::this_thread::sleep_for(milliseconds(200));
  }
  field.tell(fmt::format("a trickling reader is let go after {:.0f} s",
                         milliseconds_since(began) / 1000.0));
}

void hang_ups(Field& field) {
  for (int i = 0; i < 2000; ++i) {
    Wire wire(field.port());
    if (i % 4 == 1) wire.send_some(slow_head());
    if (i % 4 == 2) wire.send_some(slow_body());
    if (i % 4 == 3) wire.send_some(head_of("GET", "/openapi.json"));
    const linger at_once{1, 0};
    ::setsockopt(wire.descriptor(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  }
  field.expect_serving();
}

}  // namespace

std::span<const Attack> crowd_attacks() {
  static constexpr std::array kRows = {
      Attack{"slowloris", "200 connections that send a byte now and then", slowloris},
      Attack{"slow-crowd", "more slow connections than places", slow_crowd},
      Attack{"drip", "a body that never stops and never ends", drip_ends},
      Attack{"idle-keep-alives", "more idle connections than places", idle_keep_alives},
      Attack{"one-address", "one address takes all places, fast enough", one_address},
      Attack{"deaf-clients", "more downloads that nobody reads than places", deaf_clients},
      Attack{"slow-reader", "a download that is read by 64 bytes", slow_reader_ends},
      Attack{"hang-ups", "2000 connections that are reset", hang_ups}};
  return kRows;
}

}  // namespace fairway::hostile
