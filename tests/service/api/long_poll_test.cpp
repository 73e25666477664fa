// Versions of the job document, and waiting for the next one.
#include <chrono>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/service/support/job_follower.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kLong = R"({"method":"anisotropic_prescribed","steps":10000})";

/// A service whose only worker is busy, and a job that waits behind it.
class Fixture {
 public:
  Fixture() {
    wait_until_busy(client(), running_);
    waiting_ = submit(client(), small_glb());
    tag_ = client().get(waiting_).header("etag");
  }

  HttpClient client() const { return service_.client(); }
  ServiceProcess& service() { return service_; }
  const std::string& waiting() const { return waiting_; }
  const std::string& tag() const { return tag_; }
  void free_worker() const { client().remove(running_); }

  Answer get(const std::string& prefer, const std::string& tag) const {
    return client().get(waiting_, {{"If-None-Match", tag}, {"Prefer", prefer}});
  }
  /// A long poll that has been sent and most likely read.
  RawConnection poll(int seconds) const {
    RawConnection connection(service_.port());
    connection.send(
        fmt::format("GET {} HTTP/1.1\r\nHost: t\r\nIf-None-Match: {}\r\nPrefer: wait={}\r\n\r\n",
                    waiting_, tag_, seconds));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    return connection;
  }

 private:
  TemporaryDirectory directory_;
  ServiceProcess service_{directory_.path(), {"--workers", "1"}};
  std::string running_ = submit(client(), noisy_torus(300), kLong);
  std::string waiting_;
  std::string tag_;
};

}  // namespace

TEST_CASE("a job document has its revision as a version") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string path = submit(client, small_glb());
  const Json job = wait_until_final(client, path);
  const Answer answer = client.get(path);
  const std::string tag = fmt::format("\"r{}\"", job["revision"].get<int>());
  CHECK(answer.header("etag") == "W/" + tag);
  CHECK(answer.header("cache-control") == "private, no-cache");
  const Answer same = client.get(path, {{"If-None-Match", tag}});
  CHECK(same.status == 304);
  CHECK(same.body.empty());
  CHECK(same.header("etag") == "W/" + tag);
  CHECK(same.header("preference-applied").empty());
  CHECK(client.get(path, {{"If-None-Match", "\"r1\""}}).status == 200);
  CHECK(client.get(path, {{"If-Match", tag}}).problem() == "precondition_failed");
  CHECK(client.get(path, {{"Prefer", "wait=60"}}).header("preference-applied").empty());
}

TEST_CASE("a long poll is answered when the job changes") {
  const Fixture f;
  RawConnection poll = f.poll(999);
  f.free_worker();
  const std::string head = poll.read_until("\r\n\r\n");
  CHECK(head.starts_with("HTTP/1.1 200 "));
  CHECK(head.find("Preference-Applied: wait=60\r\n") != std::string::npos);
  CHECK(head.find("ETag: " + f.tag()) == std::string::npos);
  CHECK(poll.read_until("\"state\":").find("\"revision\"") == std::string::npos);
}

TEST_CASE("a long poll for what has changed already is answered at once") {
  const Fixture f;
  const Answer answer = f.get("wait=60", "W/\"r0\"");
  CHECK(answer.status == 200);
  CHECK(answer.json()["state"] == "queued");
  CHECK(answer.header("preference-applied") == "wait=60");
}

TEST_CASE("a long poll ends when its time is up, and not before") {
  const Fixture f;
  const auto begin = std::chrono::steady_clock::now();
  const Answer answer = f.get("wait=1", f.tag());
  CHECK(std::chrono::steady_clock::now() - begin >= std::chrono::seconds(1));
  CHECK(answer.status == 304);
  CHECK(answer.header("preference-applied") == "wait=1");
  CHECK(answer.header("etag") == f.tag());
}

TEST_CASE("a long poll does not keep a server from stopping") {
  Fixture f;
  RawConnection poll = f.poll(60);
  CHECK(f.service().stop().code == 0);
  const std::string answer = poll.read_all();
  CHECK(answer.starts_with("HTTP/1.1 304 "));
  CHECK(answer.find("Connection: close\r\n") != std::string::npos);
}
