#pragma once

#include <chrono>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "tests/service/support/http_client.h"

namespace fairway::test {

inline constexpr std::chrono::seconds kPatience{120};

/// Asks for a job's document until `enough` says so; fails the test after a long while.
template <class Enough>
Json follow(const HttpClient& client, const std::string& path, const Enough& enough,
            const HttpClient::Headers& headers = {}) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    const Answer answer = client.get(path, headers);
    REQUIRE(answer.status == 200);
    Json job = answer.json();
    if (enough(job)) return job;
    CAPTURE(job.dump());
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

/// The document once the job has come to its end.
inline Json wait_until_final(const HttpClient& client, const std::string& path) {
  return follow(client, path, [](const Json& job) {
    const std::string state = job["state"];
    return state != "queued" && state != "running";
  });
}

/// The document once the job's worker is at its steps.
inline Json wait_until_busy(const HttpClient& client, const std::string& path) {
  return follow(client, path, [](const Json& job) {
    REQUIRE((job["state"] == "queued" || job["state"] == "running"));
    return job["state"] == "running" && job.contains("progress") && job["progress"]["step"] > 0;
  });
}

/// Asks until the answer has this status.
inline Json ask_until(const HttpClient& client, const std::string& path, int status) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    const Answer answer = client.get(path);
    CAPTURE(answer.status, answer.body);
    if (answer.status == status) return answer.json();
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

/// POSTs a mesh to /v1/jobs and returns the job's path.
inline std::string submit(const HttpClient& client, const std::string& mesh,
                          const std::string& parameters = "{}") {
  const Answer answer =
      client.post("/v1/jobs?params=" + percent_encoded(parameters), mesh, "model/gltf-binary");
  CAPTURE(answer.body);
  REQUIRE(answer.status == 202);
  CHECK(answer.header("location") == "/v1/jobs/" + answer.json()["id"].get<std::string>());
  return answer.header("location");
}

}  // namespace fairway::test
