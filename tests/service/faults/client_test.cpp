// Clients that go in the middle.
#include <filesystem>
#include <string>

#include <catch2/catch.hpp>

#include "tests/service/support/job_follower.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

TEST_CASE("clients that leave in the middle of a download harm nobody") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--workers", "1"});
  const HttpClient client = service.client();
  // Several times what the sockets hold between the two.
  const std::string path = submit(client, noisy_torus(400), R"({"steps":1})");
  REQUIRE(wait_until_final(client, path)["state"] == "succeeded");
  const Answer whole = client.get(path + "/result");
  REQUIRE(whole.status == 200);
  REQUIRE(whole.body.size() > std::size_t{8} << 20U);
  const std::size_t before = service.descriptors();
  for (int i = 0; i < 20; ++i) {
    RawConnection leaving(service.port());
    leaving.send("GET " + path + "/result HTTP/1.1\r\nHost: x\r\n\r\n");
    leaving.read_until("glTF");
    if (i % 2 == 0) leaving.close_sending();
  }
  CHECK(client.get(path + "/result").body == whole.body);
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (service.descriptors() > before) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  CHECK(client.get("/livez").status == 200);
}
