// GET /v1/jobs/{id}/events of the real service.
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/service/support/event_text.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kLong = R"({"method":"anisotropic_prescribed","steps":10000})";
/// Long enough that progress is seen on the way.
const std::string kSteps = R"({"method":"anisotropic_prescribed","steps":1500})";

std::string events_request(const std::string& path, const std::string& headers = "") {
  return fmt::format("GET {}/events HTTP/1.1\r\nHost: t\r\n{}\r\n", path, headers);
}

std::size_t open_sockets(const ServiceProcess& service) {
  std::size_t count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(fmt::format("/proc/{}/fd", service.pid()))) {
    std::error_code error;
    const auto target = std::filesystem::read_symlink(entry.path(), error).string();
    if (target.starts_with("socket:")) ++count;
  }
  return count;
}

}  // namespace

TEST_CASE("a job's events are its states and its progress, up to the end") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--workers", "1"});
  const HttpClient client = service.client();
  const std::string path = submit(client, noisy_torus(40), kSteps);
  RawConnection connection(service.port());
  connection.send(events_request(path));
  const std::string head = connection.read_until("\r\n\r\n");
  CHECK(head.starts_with("HTTP/1.1 200 "));
  CHECK(head.find("Content-Type: text/event-stream\r\n") != std::string::npos);
  CHECK(head.find("Cache-Control: no-store\r\n") != std::string::npos);
  const auto events = events_of(without_chunks(connection.read_until("\r\n0\r\n\r\n")));
  const Json job = client.get(path).json();
  REQUIRE_FALSE(events.empty());
  CHECK(events.back().name == "state");
  CHECK(events.back().data == job);
  CHECK(job["state"] == "succeeded");
  int revision = 0;
  int progress = 0;
  for (const Event& event : events) {
    CAPTURE(event.name, event.id, event.data.dump());
    if (event.name == "progress") {
      ++progress;
      CHECK(event.id.empty());
      CHECK(event.data.contains("fraction"));
    } else {
      CHECK(event.name == "state");
      CHECK(event.id == std::to_string(event.data["revision"].get<int>()));
      CHECK(event.data["revision"] > revision);
      revision = event.data["revision"];
    }
  }
  CHECK(progress > 0);
  // The connection goes on.
  connection.send("GET /livez HTTP/1.1\r\nHost: t\r\n\r\n");
  CHECK(connection.read_until("alive").starts_with("HTTP/1.1 200 "));
}

TEST_CASE("a stream is taken up after the last event, and has no more after the end") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb());
  const int revision = wait_until_final(client, path)["revision"];
  const auto get = [&](const std::string& last) {
    return client.get(path + "/events", {{"Last-Event-ID", last}});
  };
  const Answer end = get(std::to_string(revision));
  CHECK(end.status == 204);
  CHECK(end.header("content-length").empty());
  for (const std::string& last : {std::string(), std::to_string(revision - 1)}) {
    const auto events = events_of(get(last).body);
    REQUIRE(events.size() == 1);
    CHECK(events.front().id == std::to_string(revision));
  }
  CHECK(get("x").problem() == "bad_request");
  CHECK(client.get("/v1/jobs/AAAAAAAAAAAAAAAAAAAAAA/events").problem() == "not_found");
  CHECK(client.post(path + "/events").problem() == "method_not_allowed");
  CHECK(client.head(path + "/events").header("content-type") == "text/event-stream");
}

TEST_CASE("a client of HTTP/1.0 gets events without chunks") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb());
  wait_until_final(client, path);
  RawConnection connection(service.port());
  connection.send("GET " + path + "/events HTTP/1.0\r\n\r\n");
  const std::string answer = connection.read_all();
  CHECK(answer.find("Transfer-Encoding") == std::string::npos);
  CHECK(answer.find("\r\n\r\n:\n\nevent: state\n") != std::string::npos);
  CHECK(answer.ends_with("\n\n"));
}

TEST_CASE("a stream ends with its server, and its thread with its client") {
  const TemporaryDirectory directory;
  ServiceProcess service(directory.path(), {"--workers", "1"});
  const HttpClient client = service.client();
  const std::string path = submit(client, noisy_torus(300), kLong);
  wait_until_busy(client, path);
  RawConnection staying(service.port());
  staying.send(events_request(path));
  staying.read_until("event: progress");
  // Of the requests before, some connections may still be open.
  const std::size_t before = open_sockets(service);
  {
    std::vector<RawConnection> leaving;
    for (int i = 0; i < 20; ++i) {
      leaving.emplace_back(service.port()).send(events_request(path));
      leaving.back().read_until("event: state");
    }
    CHECK(open_sockets(service) > before + 10);
  }
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (open_sockets(service) > before) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  CHECK(client.get(path).json()["state"] == "running");
  CHECK(service.stop().code == 0);
  CHECK(staying.read_all().ends_with("\r\n0\r\n\r\n"));
}
