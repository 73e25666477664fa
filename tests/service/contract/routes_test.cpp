#include "server/fairwayd/api/routes.h"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "server/os/random_id.h"

using namespace fairway;

TEST_CASE("the paths of the API lead to their places") {
  const std::string id = random_id();
  const auto place = [](const std::string& path) {
    const auto route = route_of(path);
    REQUIRE(route);
    return route->place;
  };
  CHECK(place("/livez") == Place::livez);
  CHECK(place("/readyz") == Place::readyz);
  CHECK(place("/metrics") == Place::metrics);
  CHECK(place("/v1/jobs") == Place::jobs);
  CHECK(place("/v1/denoise") == Place::denoise);
  CHECK(place("/v1/inspect") == Place::inspect);
  CHECK(place("/v1/uploads") == Place::uploads);
  CHECK(place("/v1/uploads/" + id) == Place::upload);
  CHECK(place("/v1/jobs/" + id) == Place::job);
  CHECK(place("/v1/jobs/" + id + "/result") == Place::job_result);
  CHECK(place("/v1/jobs/" + id + "/events") == Place::job_events);
  CHECK(place("/v1/jobs/" + id + "/cancel") == Place::job_cancel);
  CHECK(place("/v1/jobs/" + id + "/deliveries") == Place::job_deliveries);
  CHECK(place("/v1/jobs/" + id + "/deliveries/msg_1/redeliver") == Place::job_redeliver);
  CHECK(route_of("/v1/jobs/" + id + "/deliveries/msg_1/redeliver")->delivery == "msg_1");
  CHECK(route_of("/v1/jobs/" + id)->id == id);
  CHECK(place("/") == Place::page);
  CHECK(place("/assets/main-AB12.js") == Place::page_file);
  CHECK(place("/samples/ring.glb") == Place::sample);
  CHECK(place("/docs") == Place::docs);
  CHECK(place("/docs/parameters") == Place::docs_file);
}

TEST_CASE("other paths lead nowhere") {
  const std::string id = random_id();
  const std::vector<std::string> paths = {"",
                                          "/assets/",
                                          "/assets/.hidden",
                                          "/assets/a/b.js",
                                          "/docs/../secret",
                                          "/docs/" + std::string(101, 'x'),
                                          "/v1/jobs/",
                                          "/v1/jobsx",
                                          "/v1/jobs/../../etc/passwd",
                                          "/v1/jobs/" + std::string(65, 'x'),
                                          "/v1/jobs/" + id + "/",
                                          "/v1/jobs/" + id + "/result/",
                                          "/v1/jobs/" + id + "/deliveries/",
                                          "/v1/jobs/" + id + "/deliveries//redeliver",
                                          "/v1/jobs/" + id + "/deliveries/a/b/redeliver",
                                          "/v1/jobs/" + id + "/deliveries/msg_1",
                                          "//v1/jobs",
                                          "/v1/jobs/\n"};
  for (const std::string& path : paths) {
    CAPTURE(path);
    CHECK_FALSE(route_of(path));
  }
}

TEST_CASE("a method is allowed exactly where it is listed") {
  CHECK(is_allowed(Place::jobs, "POST"));
  CHECK(is_allowed(Place::jobs, "HEAD"));
  CHECK_FALSE(is_allowed(Place::jobs, "DELETE"));
  CHECK_FALSE(is_allowed(Place::jobs, "GE"));
  CHECK_FALSE(is_allowed(Place::livez, ""));
  CHECK(is_allowed(Place::job, "DELETE"));
  CHECK(is_allowed(Place::inspect, "POST"));
  CHECK_FALSE(is_allowed(Place::inspect, "GET"));
}

TEST_CASE("a body is wanted where something is sent") {
  CHECK(takes_body(Place::jobs, "POST"));
  CHECK(takes_body(Place::denoise, "POST"));
  CHECK(takes_body(Place::upload, "PATCH"));
  CHECK_FALSE(takes_body(Place::upload, "HEAD"));
  CHECK_FALSE(takes_body(Place::jobs, "GET"));
  CHECK_FALSE(takes_body(Place::job_cancel, "POST"));
}

TEST_CASE("a body that is work is a submit, a piece of a file is none") {
  CHECK(is_submit(Place::jobs, "POST"));
  CHECK(is_submit(Place::job, "PUT"));
  CHECK_FALSE(is_submit(Place::uploads, "POST"));
  CHECK_FALSE(is_submit(Place::upload, "PATCH"));
  CHECK_FALSE(is_submit(Place::jobs, "GET"));
}

TEST_CASE("health is open everywhere, metrics and the API where they belong") {
  for (const Entrance entrance : {Entrance::only, Entrance::main, Entrance::admin}) {
    CHECK(is_open(Place::livez, entrance));
    CHECK(is_open(Place::readyz, entrance));
    CHECK(is_open(Place::metrics, entrance) == (entrance != Entrance::main));
    CHECK(is_open(Place::jobs, entrance) == (entrance != Entrance::admin));
    CHECK(is_open(Place::denoise, entrance) == (entrance != Entrance::admin));
  }
}

TEST_CASE("a place is named by its pattern") {
  CHECK(pattern_of(route_of("/v1/jobs/" + random_id() + "/result")->place) ==
        "/v1/jobs/{id}/result");
}
