// POST /v1/inspect of the real service with the real worker.

#include <chrono>
#include <filesystem>
#include <iterator>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/sample_scene.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kLong = R"({"method":"anisotropic_prescribed","steps":10000})";

bool nothing_is_left(const std::filesystem::path& data) {
  return std::filesystem::is_empty(data / "spool") && std::filesystem::is_empty(data / "blobs");
}

/// Waits until a condition holds; fails the test after a long while.
template <class Condition>
void wait_until(const Condition& holds) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!holds()) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

std::ptrdiff_t files(const std::filesystem::path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder),
                       std::filesystem::directory_iterator());
}

/// How many jobs the store knows.
std::size_t jobs(const HttpClient& client) {
  return client.get("/v1/jobs").json()["jobs"].size();
}

}  // namespace

TEST_CASE("an inspection answers its document and leaves no job, no blob and no spool file") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const std::string mesh = noisy_torus(20);
  const Answer answer = client.post("/v1/inspect", mesh, "model/gltf-binary");
  CAPTURE(answer.body);
  REQUIRE(answer.status == 200);
  CHECK(answer.header("content-type") == "application/json");
  const Json document = answer.json();
  CHECK(document["format"] == "glb");
  CHECK(document["bytes"] == mesh.size());
  CHECK(document["surfaces"][0]["genus"] == 1);
  CHECK(document["surfaces"][0]["noise"].get<double>() == Approx(0.2).margin(0.05));
  CHECK(document["surfaces"][0]["clean"] == false);
  CHECK(document["estimate"]["steps"] == 24);
  CHECK(jobs(client) == 0);
  wait_until([&] { return nothing_is_left(directory.path()); });
}

TEST_CASE("a form with a scene and its files is inspected like the mesh alone") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const SampleScene scene;
  auto parts = scene.parts("{}");
  parts.push_back({"unneeded.bin", "", "x"});
  const Answer answer = service.client().post("/v1/inspect", form_body(parts), kFormType);
  CAPTURE(answer.body);
  REQUIRE(answer.status == 200);
  const Json document = answer.json();
  CHECK(document["format"] == "gltf");
  CHECK(document["surfaces"][0]["boundary_loops"] == 0);
  CHECK(document["warnings"].dump().find("unneeded.bin") != std::string::npos);
}

TEST_CASE("an inspection is refused as a job is") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--max-body", "2000"});
  const HttpClient client = service.client();
  const auto problem = [&](const std::string& mesh, int status, const std::string& query = "") {
    const Answer answer = client.post("/v1/inspect" + query, mesh, "model/gltf-binary");
    CHECK(answer.status == status);
    return answer.problem();
  };
  CHECK(client.post("/v1/inspect", small_glb()).status == 200);
  CHECK(problem(small_glb(Flaw::truncated), 400) == "malformed_input");
  CHECK(problem(small_glb(Flaw::index_out_of_range), 422) == "invalid_mesh");
  CHECK(problem(small_glb(Flaw::not_a_number), 422) == "invalid_mesh");
  CHECK(problem(std::string(2001, 'x'), 413) == "too_large");
  CHECK(problem(small_glb(), 422, "?params=%7B%22stepz%22:1%7D") == "invalid_parameters");
  CHECK(client.get("/v1/inspect").header("allow") == "POST, OPTIONS");
  wait_until([&] { return nothing_is_left(directory.path()); });
}

TEST_CASE("an inspection waits for a slot, counts in the queue, and leaves it with its client") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--workers", "1", "--queue", "1"});
  const HttpClient client = service.client();
  const std::string running = submit(client, noisy_torus(300), kLong);
  wait_until_busy(client, running);
  Answer waiting;
  std::jthread asks([&] { waiting = client.post("/v1/inspect", small_glb()); });
  // The output of the running job, and the upload; then it only has to be put in line.
  wait_until([&] { return files(directory.path() / "spool") == 2; });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(client.post("/v1/inspect", small_glb()).problem() == "queue_full");
  CHECK(client.post("/v1/jobs", small_glb()).problem() == "queue_full");
  client.remove(running);
  asks.join();
  CHECK(waiting.status == 200);

  const std::string again = submit(client, noisy_torus(300), kLong);
  wait_until_busy(client, again);
  // raw() hangs up after two seconds without an answer.
  const std::string mesh = small_glb();
  const std::string answer = client.raw("POST /v1/inspect HTTP/1.1\r\nHost: t\r\nContent-Length: " +
                                        std::to_string(mesh.size()) + "\r\n\r\n" + mesh);
  CHECK(answer.empty());
  wait_until([&] { return client.post("/v1/jobs", small_glb()).status == 202; });
  CHECK(client.get(again).json()["state"] == "running");
  client.remove(again);
}

TEST_CASE("an inspection that meets its deadline is refused with the limit") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--deadline", "1"});
  const Answer answer = service.client().post("/v1/inspect", noisy_torus(1000));
  CHECK(answer.status == 422);
  CHECK(answer.problem() == "time_limit");
}
