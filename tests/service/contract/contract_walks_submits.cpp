// How to get every documented answer of the operations that make a job.

#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "server/os/random_id.h"
#include "tests/service/contract/contract_walks.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/uploads/tus_client.h"

namespace fairway::test {
namespace {

bool waits(const ContractWalk& walk) {
  return walk.operation().id == "denoise";
}

/// The same submit again, and another one under the same key.
void see_keys(ContractWalk& walk) {
  const Stage stage({"--workers", "1"});
  if (!waits(walk)) {
    wait_until_busy(stage.client(), submit(stage.client(), noisy_torus(300), kEndless));
  }
  WireRequest request = upload(walk, noisy_torus(10));
  request.headers.emplace_back("Idempotency-Key: scan-7");
  const Answer first = stage.ask(request);
  walk.see(first);
  CHECK(first.status == (waits(walk) ? 200 : 202));
  const Answer again = stage.ask(request);
  walk.see(again);
  CHECK(again.status == 200);
  request.path += "&priority=1";
  const Answer other = stage.ask(request);
  walk.see(other);
  CHECK(other.problem() == "key_reused");
}

/// A submit whose first try is still on its way.
void see_flight(ContractWalk& walk) {
  const Stage stage;
  WireRequest request = upload(walk, std::string(100, 'x'));
  request.headers.emplace_back("Idempotency-Key: scan-8");
  RawConnection slow(stage.service.port());
  slow.send(
      fmt::format("{} {} HTTP/1.1\r\nHost: t\r\nContent-Length: 1000\r\nContent-Type: "
                  "model/gltf-binary\r\nIdempotency-Key: scan-8\r\nExpect: 100-continue\r\n\r\n",
                  request.method, request.path));
  slow.read_until("100 Continue\r\n\r\n");  // its body is waited for: it is on its way
  const Answer answer = stage.ask(request);
  walk.see(answer);
  CHECK(answer.problem() == "conflict");
}

/// Results and inputs of earlier jobs.
void see_earlier(ContractWalk& walk) {
  const Stage stage;
  const std::string mesh = noisy_torus(10);
  const Json job = wait_until_final(stage.client(), submit(stage.client(), mesh));
  const Answer equal = stage.ask(upload(walk, mesh));
  walk.see(equal);
  CHECK(equal.status == 200);
  WireRequest anew = upload(walk, mesh);
  anew.headers.emplace_back("Cache-Control: no-cache");
  const Answer again = stage.ask(anew);
  walk.see(again);
  CHECK(again.status == (waits(walk) ? 200 : 202));
  WireRequest named = upload(walk, "", R"({"steps":2})");
  named.path += "&input=sha256:" + job["input"]["sha256"].get<std::string>();
  const Answer found = stage.ask(named);
  walk.see(found);
  CHECK(found.status == (waits(walk) ? 200 : 202));
  named.path = upload(walk, "").path + "&input=sha256:" + std::string(64, '0');
  const Answer unknown = stage.ask(named);
  walk.see(unknown);
  CHECK(unknown.status == 404);
}

/// Uploads in pieces in place of a body.
void see_resumed(ContractWalk& walk) {
  const Stage stage;
  const TusClient client(stage.client());
  const std::string mesh = noisy_torus(10);
  const auto with = [&](const std::string& id, const std::string& parameters = "{}") {
    WireRequest request = upload(walk, "", parameters);
    request.path += "&upload=" + id;
    return request;
  };
  const auto seen = [&](const WireRequest& request) {
    Answer answer = stage.ask(request);
    walk.see(answer);
    return answer;
  };
  const WireRequest first = with(id_of_upload(client.upload(mesh)));
  CHECK(seen(first).status == (waits(walk) ? 200 : 202));
  WireRequest other = upload(walk, "", R"({"steps":3})");
  other.path += first.path.substr(first.path.find("&upload="));
  CHECK(seen(other).problem() == "gone");
  const std::string half = client.created(mesh.size());
  client.patch(half, 0, mesh.substr(0, mesh.size() / 2));
  CHECK(seen(with(id_of_upload(half))).problem() == "not_ready");
  CHECK(seen(with(kNobody)).problem() == "not_found");
  CHECK(seen(with(id_of_upload(client.upload(std::string(100, '\x01'))))).status == 415);
}

/// What is asked of a job beside its parameters, in the query and in a form.
void see_options(ContractWalk& walk) {
  const Stage stage;
  const auto status = [&](const WireRequest& request) {
    const Answer answer = stage.ask(request);
    walk.see(answer);
    return answer.status;
  };
  const auto with = [&](const std::string& query) {
    WireRequest request = upload(walk, small_glb());
    request.path += query;
    return status(request);
  };
  CHECK(with("&ttl=auto&deadline=auto&priority=-10") < 300);
  CHECK(with("&priority=11") == 422);
  CHECK(with("&label=a%20b") == 422);
  CHECK(with("&ttl=60&ttl=61") == 400);
  CHECK(with("&input=md5:00") == 400);
  CHECK(with("&webhook=" + percent_encoded("http://203.0.113.7/?token=t")) < 300);
  CHECK(with("&webhook=nowhere") == 422);
  const auto part = [&](const std::string& options) {
    return status(form(walk, {{"a.glb", "", small_glb()}, {"job", "", options}}));
  };
  CHECK(part(R"({"labels":["red"],"priority":2,"ttl":600,"deadline":30})") < 300);
  CHECK(part(R"({"webhook":{"url":"https://203.0.113.7/"}})") < 300);
  CHECK(part(R"({"webhook":{}})") == 422);
  CHECK(part(R"({"labels":"red"})") == 422);
  CHECK(part("{") == 400);
}

/// An id has one submit.
void see_ids(ContractWalk& walk) {
  const Stage stage;
  WireRequest request = upload(walk, noisy_torus(10));
  const Answer made = stage.ask(request);
  walk.see(made);
  CHECK(made.header("location") == request.path.substr(0, request.path.find('?')));
  const Answer again = stage.ask(request);
  walk.see(again);
  CHECK(again.status == 200);
  request.body = small_glb();
  const Answer other = stage.ask(request);
  walk.see(other);
  CHECK(other.problem() == "conflict");
  for (const std::string& wrong : {std::string(65, 'x'), std::string("a%2Fb")}) {
    const Answer answer = ask(walk, stage, path_with(walk.operation(), wrong));
    walk.see(answer);
    CHECK(answer.status == 404);
  }
}

}  // namespace

void see_submits(ContractWalk& walk) {
  see_keys(walk);
  see_flight(walk);
  see_earlier(walk);
  see_resumed(walk);
  see_options(walk);
  see_shares(walk);
}

void walk_submit_job(ContractWalk& walk) {
  see_uploads(walk);
  see_submits(walk);
}

void walk_put_job(ContractWalk& walk) {
  see_uploads(walk);
  see_submits(walk);
  see_ids(walk);
}

}  // namespace fairway::test
