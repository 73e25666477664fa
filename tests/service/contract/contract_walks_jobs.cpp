// How to get every documented answer about jobs.

#include <filesystem>
#include <fstream>

#include <catch2/catch.hpp>

#include "tests/service/contract/contract_walks.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"

namespace fairway::test {
namespace {

/// The examples of all parameters in the query, as a client would send them.
std::string example_query(const ContractWalk& walk) {
  std::string query;
  for (const Json& parameter : walk.operation().parameters) {
    if (parameter["in"] != "query") continue;
    query += query.empty() ? '?' : '&';
    query += query_text(parameter, parameter["example"]);
  }
  return query;
}

/// Versions of a job that has come to its end.
void see_versions(ContractWalk& walk, const Stage& stage, const std::string& path) {
  const std::string tag = ask(walk, stage, path).header("etag");
  const auto get = [&](const std::vector<std::string>& headers) {
    Answer answer = ask(walk, stage, path, headers);
    walk.see(answer);
    return answer;
  };
  CHECK(get({"If-None-Match: " + tag}).status == 304);
  const Answer waited = get({"If-None-Match: " + tag, "Prefer: wait=1"});
  CHECK(waited.status == 304);
  CHECK(waited.header("preference-applied") == "wait=1");
  const Answer other = get({"If-None-Match: W/\"r0\"", "Prefer: wait=60"});
  CHECK(other.status == 200);
  CHECK(other.header("preference-applied") == "wait=60");
  CHECK(get({"If-Match: " + tag}).status == 412);
}

}  // namespace

void see_job_refusals(ContractWalk& walk, const Stage& stage) {
  const std::string nobody = path_with(walk.operation(), kNobody);
  walk.see(ask(walk, stage, nobody));
  walk.see(ask(walk, stage, path_with(walk.operation(), "no-id")));
  see_header_examples(walk, stage, {walk.operation().method, nobody, {}, ""});
  see_common(walk, stage, nobody);
  break_store(stage);
  walk.see(ask(walk, stage, nobody));
}

void walk_list_jobs(ContractWalk& walk) {
  const Stage stage({"--workers", "1"});
  const std::string options = "?label=red&label=batch:7&params=" + percent_encoded(kEndless);
  const Answer busy = stage.client().post("/v1/jobs" + options, noisy_torus(300));
  REQUIRE(busy.status == 202);
  wait_until_busy(stage.client(), busy.header("location"));
  walk.see(ask(walk, stage, "/v1/jobs"));
  const Answer running = ask(walk, stage, "/v1/jobs" + example_query(walk));
  walk.see(running);
  CHECK(running.json()["jobs"].size() == 1);
  submit(stage.client(), small_glb());
  const Answer first = ask(walk, stage, "/v1/jobs?limit=1");
  walk.see(first);
  const Answer second = ask(walk, stage, "/v1/jobs?cursor=" + first.json().value("next", "none"));
  walk.see(second);
  CHECK(second.json()["jobs"][0]["links"]["self"] == busy.header("location"));
  check_head(walk, stage, "/v1/jobs?state=failed");
  for (const char* wrong : {"?limit=0", "?limit=201", "?state=lost", "?what=1", "?limit=x",
                            "?label=a%20b", "?cursor=x"}) {
    walk.see(ask(walk, stage, std::string("/v1/jobs") + wrong));
  }
  see_header_examples(walk, stage, {"GET", "/v1/jobs", {}, ""});
  see_common(walk, stage, "/v1/jobs");
  break_store(stage);
  walk.see(ask(walk, stage, "/v1/jobs"));
}

void walk_show_job(ContractWalk& walk) {
  const Stage stage({"--workers", "1"});
  const HttpClient client = stage.client();
  const std::string busy = submit(client, noisy_torus(300), kEndless);
  const Json job = wait_until_busy(client, busy);
  const std::string fine = submit(client, noisy_torus(10), R"({"steps":2})");
  const std::string broken = submit(client, small_glb(Flaw::not_a_number));
  walk.see(ask(walk, stage, busy));
  walk.see(ask(walk, stage, fine));
  client.remove(busy);
  wait_until_final(client, fine);
  wait_until_final(client, broken);
  const std::string canceled = submit(client, noisy_torus(300), kEndless);
  client.post(canceled + "/cancel");
  for (const std::string& path : {busy, fine, broken, canceled}) walk.see(ask(walk, stage, path));
  check_head(walk, stage, fine);
  see_versions(walk, stage, fine);
  see_header_examples(walk, stage, {"GET", fine, {}, ""});
  see_job_refusals(walk, stage);
}

void walk_delete_job(ContractWalk& walk) {
  const Stage stage({"--workers", "1"});
  const HttpClient client = stage.client();
  const std::string busy = submit(client, noisy_torus(300), kEndless);
  wait_until_busy(client, busy);
  const std::string waiting = submit(client, small_glb());
  for (const std::string& path : {waiting, busy, busy}) walk.see(ask(walk, stage, path));
  see_job_refusals(walk, stage);
}

void walk_cancel_job(ContractWalk& walk) {
  const Stage stage({"--workers", "1"});
  const HttpClient client = stage.client();
  const std::string busy = submit(client, noisy_torus(300), kEndless);
  wait_until_busy(client, busy);
  const std::string waiting = submit(client, small_glb());
  for (const std::string& path : {waiting, busy, busy}) {
    walk.see(ask(walk, stage, path + "/cancel"));
  }
  see_job_refusals(walk, stage);
}

void walk_retry_job(ContractWalk& walk) {
  const Stage stage({"--workers", "1", "--queue", "1"});
  const HttpClient client = stage.client();
  const auto retry = [&](const std::string& path) {
    const Answer answer = ask(walk, stage, path + "/retry");
    walk.see(answer);
    return answer.status;
  };
  const std::string busy = submit(client, noisy_torus(300), kEndless);
  wait_until_busy(client, busy);
  CHECK(retry(busy) == 409);
  const std::string waiting = submit(client, small_glb());
  client.post(waiting + "/cancel");
  CHECK(retry(waiting) == 202);
  client.post(waiting + "/cancel");
  submit(client, noisy_torus(10));
  CHECK(retry(waiting) == 429);
  client.remove(waiting);
  CHECK(retry(waiting) == 410);
  std::filesystem::remove_all(stage.directory.path() / "blobs");
  std::ofstream(stage.directory.path() / "blobs") << "no folder";
  CHECK(retry(waiting) == 503);
  see_job_refusals(walk, stage);
}

void walk_follow_job(ContractWalk& walk) {
  const Stage stage({"--workers", "1"});
  const HttpClient client = stage.client();
  // Long enough that progress is seen on the way.
  const std::string steps = R"({"method":"anisotropic_prescribed","steps":1500})";
  const std::string path = submit(client, noisy_torus(40), steps);
  walk.see(ask(walk, stage, path + "/events"));
  const Json job = wait_until_final(client, path);
  const auto after = [&](const std::string& event) {
    const Answer answer = ask(walk, stage, path + "/events", {"Last-Event-ID: " + event});
    walk.see(answer);
    return answer.status;
  };
  CHECK(after(job["revision"].dump()) == 204);
  CHECK(after("1") == 200);
  CHECK(after("x") == 400);
  const Answer head = stage.ask({"HEAD", path + "/events", {}, ""});
  CHECK(head.status == 200);
  CHECK(head.header("content-type") == "text/event-stream");
  CHECK(head.body.empty());
  see_header_examples(walk, stage, {"GET", path + "/events", {}, ""});
  see_job_refusals(walk, stage);
}

}  // namespace fairway::test
