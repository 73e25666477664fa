// The client over TLS.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/submit/submit_fixture.h"
#include "tests/submit/tls_front.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// A service behind TLS.
struct Place : SubmitPlace {
  explicit Place(std::size_t cut_after = std::numeric_limits<std::size_t>::max(),
                 const std::vector<std::string>& options = {})
      : service(data(), options), front(service.port(), certificate, cut_after) {}

  SubmitRun run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(),
                     {"--server", fmt::format("https://127.0.0.1:{}", front.port()), "--out",
                      out().string(), "--json"});
    return SubmitProcess(arguments).wait();
  }

  std::string certificate = write("certificate.pem", "");
  ServiceProcess service;
  TlsFront front;
};

}  // namespace

TEST_CASE("a batch goes over TLS to a server whose certificate is trusted") {
  const Place place;
  auto arguments = place.write_meshes(10);
  arguments.insert(arguments.end(), {"--ca-cert", place.certificate});
  const SubmitRun run = place.run(arguments);
  CAPTURE(run.errors);
  CHECK(run.code == 0);
  CHECK(place.results().size() == 10);
}

TEST_CASE("nothing is sent to a server whose certificate is not trusted") {
  const Place place;
  const SubmitRun run = place.run(place.write_meshes(3));
  CHECK(run.code == 3);
  CHECK(run.errors.find("--ca-cert") != std::string::npos);
  CHECK(place.service.client().get("/v1/jobs").json()["jobs"].empty());
}

TEST_CASE("an upload that is always cut off over TLS fails by itself, and the rest goes on") {
  const auto refusing = GENERATE(false, true);
  const Place place(refusing ? std::numeric_limits<std::size_t>::max() : 400'000,
                    {"--max-body", "100000"});
  auto arguments = place.write_meshes(1);
  arguments.insert(arguments.begin(),
                   place.write("large.glb", small_glb() + std::string(30 << 20, 'x')));
  arguments.insert(arguments.end(), {"--ca-cert", place.certificate, "--retry-for", "3"});
  const SubmitRun run = place.run(arguments);
  CAPTURE(refusing, run.errors);
  CHECK(run.code == 1);
  CHECK_FALSE(run.summary()["files"][0].contains("result"));
  CHECK(run.summary()["files"][1]["state"] == "succeeded");
}
