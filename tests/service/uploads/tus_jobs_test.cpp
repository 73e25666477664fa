// Jobs whose input came in pieces before.
#include <string>

#include <catch2/catch.hpp>

#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/service/uploads/tus_client.h"

using namespace fairway;
using namespace fairway::test;

namespace {

std::string job_path(const std::string& upload) {
  return "/v1/jobs?upload=" + id_of_upload(upload);
}

}  // namespace

TEST_CASE("an upload becomes a job with the same result as the file itself") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const TusClient tus(client);
  const std::string mesh = noisy_torus(10);
  const std::string upload = tus.upload(mesh);
  const Answer made = client.post(job_path(upload) + "&label=tus");
  REQUIRE(made.status == 202);
  const Json job = made.json();
  CHECK(job["input"]["sha256"] == sha256_of(mesh));
  CHECK(job["input"]["bytes"] == mesh.size());
  CHECK(tus.head(upload).status == 410);
  CHECK(std::filesystem::is_empty(directory.path() / "uploads"));
  const Json done = wait_until_final(client, made.header("location"));
  CHECK(done["state"] == "succeeded");
  const std::string direct =
      client.post("/v1/jobs", mesh, "model/gltf-binary", {{"Cache-Control", "no-cache"}})
          .header("location");
  CHECK(wait_until_final(client, direct)["result"]["sha256"] == done["result"]["sha256"]);
  // Equal work is answered from what is there.
  const Answer cached = client.post(job_path(tus.upload(mesh)));
  CHECK(cached.status == 200);
  CHECK(cached.json()["cached"] == true);
}

TEST_CASE("an upload that is not whole becomes no job, and stays") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const TusClient tus(client);
  const std::string mesh = small_glb();
  const std::string upload = tus.created(mesh.size());
  REQUIRE(tus.patch(upload, 0, mesh.substr(0, 7)).status == 204);
  const Answer early = client.post(job_path(upload));
  CHECK(early.status == 409);
  CHECK(early.problem() == "not_ready");
  CHECK(early.json()["detail"].get<std::string>().find(" 7 ") != std::string::npos);
  CHECK(client.post(job_path("/AAAAAAAAAAAAAAAAAAAAAA")).problem() == "not_found");
  CHECK(client.post(job_path("/../jobs.sqlite")).status == 404);
  CHECK(client.post(job_path(upload) + "&input=sha256:" + sha256_of(mesh)).status == 400);
  REQUIRE(tus.patch(upload, 7, mesh.substr(7)).status == 204);
  // What is wrong with the rest of the submit leaves the upload for a better one.
  CHECK(client.post(job_path(upload) + "&params=%7B%22steps%22%3A-1%7D").status == 422);
  CHECK(client.post(job_path(upload)).status == 202);
}

TEST_CASE("a retried submit of an upload finds its job, any other one is told that it is gone") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const TusClient tus(client);
  const std::string mesh = small_glb();
  const std::string path = job_path(tus.upload(mesh));
  const HttpClient::Headers key = {{"Idempotency-Key", "one"}};
  const Answer first = client.post(path, "", "text/plain", key);
  REQUIRE(first.status == 202);
  const Answer again = client.post(path, "", "text/plain", key);
  CHECK(again.status == 200);
  CHECK(again.json()["id"] == first.json()["id"]);
  CHECK(client.post(path + "&priority=1", "", "text/plain", key).problem() == "key_reused");
  const Answer other = client.post(path);
  CHECK(other.status == 410);
  CHECK(other.json()["detail"].get<std::string>().find(sha256_of(mesh)) != std::string::npos);
  CHECK(client.get("/v1/jobs").json()["jobs"].size() == 1);
  // The same under an id of the client's own.
  const std::string named = "/v1/jobs/mine?upload=" + id_of_upload(tus.upload(noisy_torus(8)));
  CHECK(client.put(named, "").status == 202);
  CHECK(client.put(named, "").status == 200);
}

TEST_CASE("the format of an upload is told by its metadata and its first bytes") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const TusClient tus(client);
  const std::string obj =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const auto submit_as = [&](const std::string& bytes, const std::string& key,
                             const std::string& value) {
    return client.post(
        job_path(tus.upload(bytes, {{"Upload-Metadata", metadata_pair(key, value)}})));
  };
  const Answer named = submit_as(obj, "filename", "a mesh.OBJ");
  REQUIRE(named.status == 202);
  CHECK(named.json()["input"]["format"] == "obj");
  CHECK(submit_as(obj + "# 2\n", "filetype", "model/obj").status == 202);
  CHECK(submit_as(small_glb(), "filetype", "model/ply").problem() == "unsupported_format");
  CHECK(submit_as(small_glb(), "filename", "mesh.ply").problem() == "unsupported_format");
}

TEST_CASE("an upload is counted once when it becomes a job") {
  const TemporaryDirectory directory;
  const std::string mesh = small_glb();
  const ServiceProcess service(directory.path(),
                               {"--quota", std::to_string(mesh.size() + mesh.size() / 2)});
  const TusClient tus(service.client());
  CHECK(service.client().post(job_path(tus.upload(mesh))).status == 202);
}

TEST_CASE("an upload is denoised while the client waits") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const TusClient tus(service.client());
  const std::string upload = tus.upload(small_glb());
  const Answer mesh = service.client().post("/v1/denoise?upload=" + id_of_upload(upload));
  CHECK(mesh.status == 200);
  CHECK(mesh.header("content-type") == "model/gltf-binary");
}
