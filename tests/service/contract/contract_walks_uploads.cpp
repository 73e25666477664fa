// How to get every documented answer of the operations that take a mesh.

#include <atomic>
#include <chrono>
#include <filesystem>
#include <set>
#include <thread>

#include <catch2/catch.hpp>
#include <sys/resource.h>

#include "server/fairwayd/store/sqlite.h"
#include "server/os/random_id.h"
#include "tests/service/contract/contract_walks.h"
#include "tests/service/support/changing_worker.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"

namespace fairway::test {
namespace {

/// The path of an upload of its own.
std::string new_path(const ContractWalk& walk) {
  return path_with(walk.operation(), random_id());
}

/// A mesh under every media type that is documented: what the service writes, it takes.
void see_media_types(ContractWalk& walk, const Stage& stage) {
  const Operation& operation = walk.operation();
  std::set<std::string> sent = {"multipart/form-data"};
  const SampleScene scene(10);
  walk.see(stage.ask(form(walk, scene.parts(R"({"steps":1})"))));
  for (const char* format : {"glb", "gltf", "drc", "ply", "obj", "stl"}) {
    CAPTURE(format);
    const std::string parameters = R"({"steps":1,"output":")" + std::string(format) + "\"}";
    const std::string path = "/v1/denoise?params=" + percent_encoded(parameters);
    const Answer made = stage.client().post(path, noisy_torus(10));
    REQUIRE(made.status == 200);
    const std::string type = made.header("content-type");
    sent.insert(type);
    walk.see(stage.ask({operation.method, new_path(walk), {"Content-Type: " + type}, made.body}));
  }
  std::set<std::string> documented;
  for (const auto& [type, media] : operation.body["content"].items()) documented.insert(type);
  CHECK(sent == documented);
}

/// Every example of the parameters, and a mesh of every way to send one.
void see_successes(ContractWalk& walk) {
  const Stage stage;
  for (const Json& parameter : walk.operation().parameters) {
    if (parameter["in"] != "query") continue;
    const std::string name = parameter["name"];
    CAPTURE(name);
    if (!parameter.contains("content")) {
      WireRequest request =
          upload(walk, name == "input" || name == "upload" ? "" : noisy_torus(10));
      request.path.append("&").append(query_text(parameter, parameter["example"]));
      walk.see(stage.ask(request));
      continue;
    }
    for (const Json& example : parameter["content"]["application/json"]["examples"]) {
      walk.see(stage.ask(upload(walk, noisy_torus(10), example["value"].dump())));
    }
  }
  see_header_examples(walk, stage, upload(walk, noisy_torus(10)));
  see_media_types(walk, stage);
}

/// What is said before or while the mesh comes in.
void see_upload_refusals(ContractWalk& walk) {
  const Stage stage({"--max-body", "2000"});
  const std::string& method = walk.operation().method;
  const std::string path = new_path(walk);
  const auto post = [&](const std::string& query, const std::string& body) {
    walk.see(stage.ask({method, path + query, {"Content-Type: application/octet-stream"}, body}));
  };
  post("?what=1", small_glb());
  post("?params=%7B", small_glb());
  post("?params=%7B%22stepz%22:1%7D", small_glb());
  post("", "\x89PNG\r\n\x1a\n" + std::string(100, 'x'));
  post("", std::string(2001, 'x'));
  walk.see(stage.ask({method, path, {"Content-Length: 0"}, ""}));
  walk.see(stage.ask({method, path, {}, small_glb(), false}));
  walk.see(stage.ask({method, path, {"Content-Encoding: gzip"}, small_glb()}));
  walk.see(stage.ask(form(walk, {{"a.glb", "", small_glb()}, {"params", "", "{"}})));
  see_common(walk, stage, path);
  std::filesystem::rename(stage.directory.path() / "spool", stage.directory.path() / "away");
  walk.see(stage.ask(upload(walk, small_glb())));
  std::filesystem::rename(stage.directory.path() / "away", stage.directory.path() / "spool");
  break_store(stage);
  walk.see(stage.ask(upload(walk, small_glb())));
}

void see_full_queue(ContractWalk& walk) {
  const Stage stage({"--workers", "1", "--queue", "1"});
  const std::string busy = submit(stage.client(), noisy_torus(300), kEndless);
  wait_until_busy(stage.client(), busy);
  submit(stage.client(), small_glb());
  walk.see(stage.ask(upload(walk, small_glb())));
}

/// A limit of file sizes is what a test can set without a disk of its own to fill.
void see_full_storage(ContractWalk& walk) {
  const Stage stage;
  const rlimit limit{std::size_t{64} << 10, std::size_t{64} << 10};
  REQUIRE(::prlimit(stage.service.pid(), RLIMIT_FSIZE, &limit, nullptr) == 0);
  walk.see(stage.ask(upload(walk, noisy_torus(100))));
  CHECK(stage.client().get("/livez").status == 200);
}

/// What only the worker finds.
void see_worker_refusals(ContractWalk& walk) {
  const Stage stage;
  const bool inspects = walk.operation().id == "inspect";
  for (const RefusedMesh& mesh : refused_meshes()) {
    if (inspects && (mesh.code == "diverged" || mesh.code == "invalid_parameters")) continue;
    const Answer answer = stage.ask(upload(walk, mesh.bytes, mesh.parameters));
    CAPTURE(mesh.code);
    walk.see(answer);
    CHECK(answer.problem() == mesh.code);
  }
}

void see_deadline(ContractWalk& walk) {
  const Stage stage({"--deadline", "1"});
  const bool inspects = walk.operation().id == "inspect";
  walk.see(stage.ask(upload(walk, noisy_torus(inspects ? 1000 : 300), kEndless)));
}

/// Sanitizers reserve terabytes of address space: there no limit can hold.
void see_memory_limit(ContractWalk& walk) {
#ifndef FAIRWAY_SANITIZED
  const Stage stage({"--worker-memory", "150000000"});
  walk.see(stage.ask(upload(walk, noisy_torus(500), R"({"steps":1})")));
#else
  static_cast<void>(walk);
#endif
}

/// Asks in a thread, and kills the workers until the answer is there.
void see_crash(ContractWalk& walk) {
  const Stage stage({"--workers", "1"});
  const WireRequest request = upload(walk, noisy_torus(400), kEndless);
  std::atomic<bool> answered = false;
  Answer answer;
  std::jthread asks([&] {
    answer = stage.ask(request);
    answered = true;
  });
  kill_workers_until(stage, [&] { return answered.load(); });
  asks.join();
  walk.see(answer);
  const ChangingWorker worker("kill -SEGV $$");
  const Stage dying({"--workers", "1", "--worker", worker.path()});
  walk.see(dying.ask(request));
}

/// The path of the only job, once it runs.
std::string running_job(const HttpClient& client) {
  Json jobs;
  follow(client, "/v1/jobs?state=running", [&](const Json& list) {
    jobs = list["jobs"];
    return jobs.size() == 1;
  });
  return jobs[0]["links"]["self"];
}

/// Somebody ends the job that a client waits for: by a cancel, or by a delete through another
/// server over the same store (through this one, the waiting client may see the cancel in it
/// first).
void see_ends_by_others(ContractWalk& walk) {
  for (const bool deletes : {false, true}) {
    const Stage stage({"--workers", "1"});
    const WireRequest request = upload(walk, noisy_torus(300), kEndless);
    Answer answer;
    std::jthread asks([&] { answer = stage.ask(request); });
    const std::string job = running_job(stage.client());
    if (deletes) {
      auto database = Database::open(stage.directory.path() / "jobs.sqlite");
      REQUIRE(database);
      REQUIRE(
          database->execute("UPDATE job SET state = 'expired', revision = revision + 1, "
                            "finished = created, lease_owner = NULL, lease_until = NULL"));
    } else {
      stage.client().post(job + "/cancel");
    }
    asks.join();
    walk.see(answer);
  }
}

void see_worker_failures(ContractWalk& walk) {
  see_worker_refusals(walk);
  see_deadline(walk);
  see_memory_limit(walk);
  see_crash(walk);
}

/// `Accept` and `Prefer` of a client that waits.
void see_negotiations(ContractWalk& walk) {
  const Stage stage({"--workers", "1"});
  const auto post = [&](const std::string& mesh, const std::string& parameters,
                        const std::vector<std::string>& headers) {
    WireRequest request = upload(walk, mesh, parameters);
    request.headers.insert(request.headers.end(), headers.begin(), headers.end());
    Answer answer = stage.ask(request);
    walk.see(answer);
    return answer;
  };
  CHECK(post(small_glb(), "{}", {"Accept: model/ply"}).header("content-type") == "model/ply");
  CHECK(post(small_glb(), "{}", {"Accept: image/png"}).status == 406);
  const Answer late = post(small_glb(), "{}", {"Accept: image/png", "Prefer: wait=60"});
  CHECK(late.status == 406);
  CHECK_FALSE(late.header("location").empty());
  CHECK(post(noisy_torus(300), kEndless, {"Prefer: wait=3"}).json()["state"] == "running");
  CHECK(post(small_glb(), R"({"steps":3})", {"Prefer: respond-async"}).json()["state"] == "queued");
}

/// The service stops, and does not wait for what runs.
void see_stop(ContractWalk& walk) {
  Stage stage({"--workers", "1", "--drain", "0"});
  const bool inspects = walk.operation().id == "inspect";
  const WireRequest request = upload(walk, noisy_torus(inspects ? 1000 : 300), kEndless);
  Answer answer;
  std::jthread asks([&] { answer = stage.ask(request); });
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (stage.service.workers().empty()) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  CHECK(stage.service.stop().code == 0);
  asks.join();
  CHECK(answer.status == 503);
  CHECK(answer.header("location").empty() == inspects);
  walk.see(answer);
}

}  // namespace

WireRequest upload(const ContractWalk& walk, const std::string& mesh,
                   const std::string& parameters) {
  return {walk.operation().method,
          new_path(walk) + "?params=" + percent_encoded(parameters),
          {"Content-Type: application/octet-stream"},
          mesh};
}

WireRequest form(const ContractWalk& walk, const std::vector<FormPart>& parts) {
  return {
      walk.operation().method, new_path(walk), {"Content-Type: " + kFormType}, form_body(parts)};
}

void see_uploads(ContractWalk& walk) {
  see_successes(walk);
  see_upload_refusals(walk);
  see_full_queue(walk);
  see_full_storage(walk);
  see_rate(walk);
}

void walk_denoise(ContractWalk& walk) {
  see_uploads(walk);
  see_submits(walk);
  see_negotiations(walk);
  see_worker_failures(walk);
  see_ends_by_others(walk);
  see_stop(walk);
}

void walk_inspect(ContractWalk& walk) {
  see_uploads(walk);
  see_worker_failures(walk);
  see_stop(walk);
}

}  // namespace fairway::test
