// A trace on its way from the request through the job into the worker, by the log.
#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include "server/fairwayd/http/trace.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kTrace = "0af7651916cd43dd8448eb211c80319c";
const std::string kTraceParent = "00-" + kTrace + "-b7ad6b7169203331-01";

std::vector<Json> log_lines(const std::filesystem::path& log) {
  std::vector<Json> lines;
  std::ifstream file(log);
  for (std::string line; std::getline(file, line);) {
    if (file.eof()) break;  // still being written
    auto json = parse_json(line);
    CAPTURE(line);
    REQUIRE(json);
    lines.push_back(*std::move(json));
  }
  return lines;
}

std::size_t count_of(const std::vector<Json>& lines, const std::string& event) {
  return static_cast<std::size_t>(std::count_if(
      lines.begin(), lines.end(), [&](const Json& line) { return line["event"] == event; }));
}

/// The log once it has so many lines of an event: they may come after the client has its answer.
std::vector<Json> wait_for(const std::filesystem::path& log, const std::string& event,
                           std::size_t count = 1) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    std::vector<Json> lines = log_lines(log);
    if (count_of(lines, event) >= count) return lines;
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

std::string post(const HttpClient& client, const std::string& path, const std::string& body,
                 const std::string& headers) {
  return client.raw("POST " + path + " HTTP/1.1\r\nHost: t\r\nConnection: close\r\n" + headers +
                    "Content-Type: model/gltf-binary\r\nContent-Length: " +
                    std::to_string(body.size()) + "\r\n\r\n" + body);
}

std::string header_of(const std::string& answer, const std::string& name) {
  const std::size_t at = answer.find("\r\n" + name + ": ");
  REQUIRE(at != std::string::npos);
  const std::size_t begin = at + 4 + name.size();
  return answer.substr(begin, answer.find("\r\n", begin) - begin);
}

}  // namespace

TEST_CASE("a trace goes from the submit through every line of the job to its end") {
  const TemporaryDirectory directory;
  const TemporaryDirectory logs;
  const auto log = logs.path() / "log";
  const ServiceProcess service(directory.path(), {}, log);
  const std::string answer = post(service.client(), "/v1/jobs", small_glb(Flaw::not_a_number),
                                  "traceparent: " + kTraceParent + "\r\n");
  REQUIRE(answer.starts_with("HTTP/1.1 202 "));
  const auto own = parse_traceparent(header_of(answer, "traceparent"));
  REQUIRE(own);
  CHECK(own->trace_id == kTrace);
  CHECK(own->sampled);
  CHECK(kTraceParent.find(own->span_id) == std::string::npos);
  const std::string path = header_of(answer, "Location");
  const std::string id = path.substr(path.rfind('/') + 1);
  wait_until_final(service.client(), path);

  std::map<std::string, int> events;
  wait_for(log, "http");
  for (const Json& line : wait_for(log, "job_state")) {
    if (line.contains("job")) {
      CAPTURE(line.dump());
      CHECK(line["job"] == id);
      CHECK(line["trace"] == kTrace);
    }
    if (line.value("trace", "") == kTrace) ++events[line["event"]];
    if (line["event"] == "worker_text") {
      CHECK(line["text"].get<std::string>().starts_with("trace " + kTrace + ": invalid_mesh: "));
    }
  }
  CHECK(events == std::map<std::string, int>{{"http", 1},
                                             {"job_queued", 1},
                                             {"job_started", 1},
                                             {"worker_text", 1},
                                             {"job_state", 1}});
}

TEST_CASE("a job goes on with its trace after the death of its server") {
  const TemporaryDirectory directory;
  const TemporaryDirectory logs;
  {
    ServiceProcess service(directory.path());
    post(service.client(), "/v1/jobs?params=%7B%22steps%22%3A10000%7D", noisy_torus(300),
         "traceparent: " + kTraceParent + "\r\n");
    service.kill();
  }
  const auto log = logs.path() / "log";
  const ServiceProcess service(directory.path(), {}, log);
  const auto lines = wait_for(log, "job_started");
  CHECK(lines.back()["trace"] == kTrace);
}

TEST_CASE("an inspection has the trace of its request") {
  const TemporaryDirectory directory;
  const TemporaryDirectory logs;
  const auto log = logs.path() / "log";
  const ServiceProcess service(directory.path(), {}, log);
  post(service.client(), "/v1/inspect", small_glb(), "traceparent: " + kTraceParent + "\r\n");
  for (const Json& line : wait_for(log, "inspected")) {
    if (line["event"] == "inspected") CHECK(line["trace"] == kTrace);
  }
}

TEST_CASE("every answer is logged with what it was, and no client's text as a route") {
  const TemporaryDirectory directory;
  const TemporaryDirectory logs;
  const auto log = logs.path() / "log";
  const ServiceProcess service(directory.path(), {}, log);
  const HttpClient client = service.client();
  const Answer answer = client.get("/livez");
  CHECK(parse_traceparent(answer.header("traceparent")));
  CHECK(client.get("/v1/jobs/AAAAAAAAAAAAAAAAAAAAAA").status == 404);
  CHECK(client.get("/secret").status == 404);
  client.raw("nonsense\r\n\r\n");
  std::vector<std::string> told;
  for (const Json& line : wait_for(log, "http", 4)) {
    if (line["event"] != "http") continue;
    told.push_back(line["method"].get<std::string>() + " " + line["route"].get<std::string>() +
                   " " + line["status"].dump());
    CHECK(line["level"] == "info");
    CHECK(line["bytes"] > 0);
    CHECK(line["ms"].is_number());
    CHECK(line["trace"].get<std::string>().size() == 32);
  }
  std::sort(told.begin(), told.end());
  CHECK(told == std::vector<std::string>{" none 400", "GET /livez 200", "GET /v1/jobs/{id} 404",
                                         "GET none 404"});
}

TEST_CASE("an answer with a mesh says how long the job waited, ran and was in its stages") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const Answer answer = client.post("/v1/denoise", noisy_torus(10));
  REQUIRE(answer.status == 200);
  const std::string timing = answer.header("server-timing");
  CAPTURE(timing);
  CHECK(timing.starts_with("queue;dur="));
  for (const char* part : {", run;dur=", ", decode;dur=", ", topology;dur=", ", flow;dur=",
                           ", curvature;dur=", ", encode;dur="}) {
    CHECK(timing.find(part) != std::string::npos);
  }
  CHECK(client.get(answer.header("location") + "/result").header("server-timing") == timing);
}

TEST_CASE("a variable that means nothing is warned of in the log") {
  const TemporaryDirectory directory;
  const TemporaryDirectory logs;
  const auto log = logs.path() / "log";
  const ServiceProcess service(directory.path(), {}, log, {"FAIRWAY_WORKRES=2"});
  CHECK(log_lines(log).front()["event"] == "unknown_variable");
  CHECK(log_lines(log).front()["name"] == "FAIRWAY_WORKRES");
  CHECK(log_lines(log).front()["level"] == "warning");
}
