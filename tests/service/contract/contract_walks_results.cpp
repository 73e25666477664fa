// How to get every documented answer about results.

#include <filesystem>
#include <fstream>

#include <catch2/catch.hpp>

#include "tests/service/contract/contract_walks.h"
#include "tests/service/support/changing_worker.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"

namespace fairway::test {
namespace {

/// The answer to a request for the result of a job that has come to its end.
Answer result_of(const Stage& stage, const std::string& mesh, const std::string& parameters) {
  const std::string path = submit(stage.client(), mesh, parameters);
  wait_until_final(stage.client(), path);
  return stage.client().get(path + "/result");
}

void see_failed_jobs(ContractWalk& walk) {
  const Stage stage;
  for (const RefusedMesh& mesh : refused_meshes()) {
    const Answer accepted =
        stage.client().post("/v1/jobs?params=" + percent_encoded(mesh.parameters), mesh.bytes);
    CAPTURE(mesh.code, accepted.body);
    REQUIRE(accepted.status == 202);
    wait_until_final(stage.client(), accepted.header("location"));
    const Answer result = stage.client().get(accepted.header("location") + "/result");
    walk.see(result);
    CHECK(result.problem() == mesh.code);
  }
}

void see_ended_jobs(ContractWalk& walk) {
  {
    const Stage stage({"--deadline", "1"});
    walk.see(result_of(stage, noisy_torus(300), kEndless));
  }
#ifndef FAIRWAY_SANITIZED
  {
    const Stage stage({"--worker-memory", "150000000"});
    walk.see(result_of(stage, noisy_torus(500), R"({"steps":1})"));
  }
#endif
  {
    const ChangingWorker worker("kill -SEGV $$");
    const Stage stage({"--workers", "1", "--worker", worker.path()});
    walk.see(result_of(stage, noisy_torus(20), "{}"));
  }
  const Stage stage({"--workers", "1"});
  const std::string path = submit(stage.client(), noisy_torus(300), kEndless);
  kill_workers_until(stage, [&] { return stage.client().get(path).json()["state"] == "failed"; });
  walk.see(stage.client().get(path + "/result"));
}

/// not_ready, canceled, gone.
void see_missing_results(ContractWalk& walk) {
  const Stage stage({"--workers", "1"});
  const HttpClient client = stage.client();
  const std::string path = submit(client, noisy_torus(300), kEndless);
  wait_until_busy(client, path);
  const Answer waits = client.get(path + "/result");
  CHECK_FALSE(waits.header("retry-after").empty());
  walk.see(waits);
  client.post(path + "/cancel");
  walk.see(client.get(path + "/result"));
  client.remove(path);
  walk.see(client.get(path + "/result"));
  walk.see(client.get("/v1/jobs/" + kNobody + "/result"));
  see_common(walk, stage, path + "/result");
}

/// Whole and in parts, in every format.
void see_formats(ContractWalk& walk, const Stage& stage) {
  for (const char* format : {"glb", "gltf", "drc", "ply", "obj", "stl"}) {
    CAPTURE(format);
    const std::string parameters = R"({"steps":1,"output":")" + std::string(format) + "\"}";
    const std::string path = submit(stage.client(), noisy_torus(10), parameters);
    wait_until_final(stage.client(), path);
    walk.see(ask(walk, stage, path + "/result"));
    see_header_examples(walk, stage, {"GET", path + "/result", {}, ""});
  }
}

/// Conditions and ranges.
void see_requests(ContractWalk& walk, const Stage& stage, const std::string& path) {
  const std::string tag = ask(walk, stage, path).header("etag");
  const auto status = [&](const std::vector<std::string>& headers) {
    const Answer answer = ask(walk, stage, path, headers);
    walk.see(answer);
    return answer.status;
  };
  CHECK(status({"If-None-Match: " + tag}) == 304);
  CHECK(status({"If-Match: " + tag}) == 200);
  CHECK(status({"If-Match: \"x\""}) == 412);
  CHECK(status({"Range: bytes=0-9", "If-Range: " + tag}) == 206);
  CHECK(status({"Range: bytes=0-9", "If-Range: \"x\""}) == 200);
  CHECK(status({"Range: bytes=0-9,20-29"}) == 206);
  CHECK(status({"Range: bytes=0-9,5-29"}) == 416);
  CHECK(status({"Range: bytes=99999999-"}) == 416);
  CHECK(status({"Accept: image/png"}) == 406);
}

void see_results(ContractWalk& walk) {
  const Stage stage;
  const HttpClient client = stage.client();
  const std::string path = submit(client, noisy_torus(10), R"({"steps":1})");
  wait_until_final(client, path);
  walk.see(client.get(path + "/result"));
  check_head(walk, stage, path + "/result");
  see_requests(walk, stage, path + "/result");
  see_formats(walk, stage);
  // A file that is lost is gone; a folder that is none is a fault of the storage.
  std::filesystem::remove_all(stage.directory.path() / "blobs");
  walk.see(client.get(path + "/result"));
  std::ofstream(stage.directory.path() / "blobs") << "no folder";
  walk.see(client.get(path + "/result"));
  break_store(stage);
  walk.see(client.get(path + "/result"));
}

}  // namespace

void walk_show_result(ContractWalk& walk) {
  see_results(walk);
  see_missing_results(walk);
  see_failed_jobs(walk);
  see_ended_jobs(walk);
}

}  // namespace fairway::test
