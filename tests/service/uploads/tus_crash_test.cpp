// Uploads in pieces of a server that is killed.
#include <fstream>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "tests/service/support/job_follower.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/service/uploads/tus_client.h"

using namespace fairway;
using namespace fairway::test;

TEST_CASE("an upload survives the death of its server in the middle of a piece") {
  const TemporaryDirectory directory;
  const std::string mesh = noisy_torus(60);
  const std::size_t third = mesh.size() / 3;
  std::string path;
  std::uint64_t acknowledged = 0;
  {
    ServiceProcess service(directory.path());
    const TusClient tus(service.client());
    path = tus.created(mesh.size());
    REQUIRE(tus.patch(path, 0, mesh.substr(0, third)).status == 204);
    RawConnection sender(service.port());
    sender.send(patch_head(path, third, mesh.size() - third) + mesh.substr(third, third));
    const auto until = std::chrono::steady_clock::now() + kPatience;
    while ((acknowledged = tus.offset(path)) <= third) {
      REQUIRE(std::chrono::steady_clock::now() < until);
    }
    service.kill();
  }
  const ServiceProcess service(directory.path());
  const TusClient tus(service.client());
  const std::uint64_t offset = tus.offset(path);
  CHECK(offset >= acknowledged);
  CHECK(offset <= 2 * third);
  REQUIRE(tus.patch(path, offset, mesh.substr(offset)).status == 204);
  const Answer job = service.client().post("/v1/jobs?upload=" + id_of_upload(path));
  REQUIRE(job.status == 202);
  CHECK(job.json()["input"]["sha256"] == sha256_of(mesh));
  CHECK(wait_until_final(service.client(), job.header("location"))["state"] == "succeeded");
}

TEST_CASE("a server that dies at a submit leaves the upload or the job") {
  const std::string mesh = noisy_torus(20);
  int jobs = 0;
  int uploads = 0;
  for (int death = 0; death < 12; ++death) {
    const TemporaryDirectory directory;
    std::string upload;
    {
      ServiceProcess service(directory.path());
      upload = TusClient(service.client()).upload(mesh);
      RawConnection submit(service.port());
      submit.send("POST /v1/jobs?upload=" + id_of_upload(upload) +
                  " HTTP/1.1\r\nHost: t\r\nContent-Length: 0\r\n\r\n");
      std::this_thread::sleep_for(std::chrono::microseconds(700 * death));
      service.kill();
    }
    const ServiceProcess service(directory.path());
    const TusClient tus(service.client());
    const Json list = service.client().get("/v1/jobs").json()["jobs"];
    const int status = tus.head(upload).status;
    CAPTURE(death, list.size(), status);
    if (list.empty()) {
      ++uploads;
      REQUIRE(tus.offset(upload) == mesh.size());
      CHECK(service.client().post("/v1/jobs?upload=" + id_of_upload(upload)).status == 202);
    } else {
      ++jobs;
      CHECK(status == 410);
      CHECK(list[0]["input"]["sha256"] == sha256_of(mesh));
      CHECK(std::filesystem::is_empty(directory.path() / "uploads"));
      const std::string path = list[0]["links"]["self"];
      CHECK(wait_until_final(service.client(), path)["state"] == "succeeded");
    }
  }
  UNSCOPED_INFO("jobs " << jobs << ", uploads " << uploads);
  CHECK(jobs + uploads == 12);
}

TEST_CASE("what a dead server left of uploads goes at the next start") {
  const TemporaryDirectory directory;
  std::string kept;
  std::string lost;
  {
    ServiceProcess service(directory.path());
    const TusClient tus(service.client());
    kept = tus.created(10);
    lost = tus.created(10);
    service.kill();
  }
  const auto uploads = directory.path() / "uploads";
  REQUIRE(std::filesystem::remove(uploads / id_of_upload(lost)));
  std::ofstream(uploads / "AAAAAAAAAAAAAAAAAAAAAA") << "left";
  const ServiceProcess service(directory.path());
  const TusClient tus(service.client());
  CHECK(tus.offset(kept) == 0);
  CHECK(tus.head(lost).status == 404);
  CHECK_FALSE(std::filesystem::exists(uploads / "AAAAAAAAAAAAAAAAAAAAAA"));
}
