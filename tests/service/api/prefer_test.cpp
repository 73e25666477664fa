// POST /v1/denoise for clients that would rather not wait.
#include <string>

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

Answer denoise(const HttpClient& client, const std::string& mesh, const std::string& prefer,
               const std::string& parameters = "{}") {
  return client.post("/v1/denoise?params=" + percent_encoded(parameters), mesh, "model/gltf-binary",
                     {{"Prefer", prefer}});
}

}  // namespace

TEST_CASE("respond-async answers with the job instead of the mesh") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const Answer answer = denoise(client, small_glb(), "respond-async");
  CHECK(answer.status == 202);
  CHECK(answer.header("preference-applied") == "respond-async");
  CHECK(answer.header("location") == "/v1/jobs/" + answer.json()["id"].get<std::string>());
  CHECK(wait_until_final(client, answer.header("location"))["state"] == "succeeded");
  // The work is done already: there is nothing to wait for.
  const Answer again = denoise(client, small_glb(), "respond-async");
  CHECK(again.status == 200);
  CHECK(again.header("content-type") == "model/gltf-binary");
  CHECK(again.body.starts_with("glTF"));
}

TEST_CASE("a job that needs longer than the client waits goes on without it") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const Answer answer = denoise(client, noisy_torus(300), "respond-async, wait=1", kLong);
  CHECK(answer.status == 202);
  CHECK(answer.header("preference-applied") == "respond-async, wait=1");
  const std::string path = answer.header("location");
  CHECK(path == "/v1/jobs/" + answer.json()["id"].get<std::string>());
  wait_until_busy(client, path);
  client.remove(path);
}

TEST_CASE("a job that is done in time is answered with its mesh or its problem") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const Answer answer = denoise(client, small_glb(), "wait=120");
  CHECK(answer.status == 200);
  CHECK(answer.body.starts_with("glTF"));
  CHECK(answer.header("preference-applied") == "wait=120");
  CHECK(answer.header("location").starts_with("/v1/jobs/"));
  CHECK(denoise(client, small_glb(Flaw::truncated), "wait=120").problem() == "malformed_input");
}

TEST_CASE("a client that prefers not to wait may hang up without losing its job") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const std::string mesh = small_glb();
  RawConnection connection(service.port());
  connection.send(
      fmt::format("POST /v1/denoise HTTP/1.1\r\nHost: t\r\nPrefer: respond-async\r\n"
                  "Content-Length: {}\r\n\r\n{}",
                  mesh.size(), mesh));
  connection.close_sending();
  const std::string answer = connection.read_all();
  CHECK(answer.starts_with("HTTP/1.1 202 "));
  const std::string location = "\r\nLocation: ";
  const std::size_t at = answer.find(location);
  REQUIRE(at != std::string::npos);
  CHECK(answer.find(location, at + 1) == std::string::npos);
  const std::size_t begin = at + location.size();
  const std::string path = answer.substr(begin, answer.find("\r\n", begin) - begin);
  CHECK(wait_until_final(service.client(), path)["state"] == "succeeded");
}
