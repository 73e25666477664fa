// How to get every documented answer about deliveries.

#include <string>

#include <catch2/catch.hpp>

#include "tests/service/contract/contract_walks.h"
#include "tests/service/webhooks/webhook_fixture.h"

namespace fairway::test {
namespace {

bool was_tried(const Json& delivery) {
  return !delivery["attempts"].empty();
}

/// Answers as its path asks for it.
std::string answer_by_path(const Received& post, std::size_t) {
  if (post.target == "/gone") return answer_of(410);
  if (post.target == "/silent") return {};
  return answer_of(post.target == "/busy" ? 503 : 204);
}

}  // namespace

void walk_list_deliveries(ContractWalk& walk) {
  WebhookReceiver receiver(answer_by_path);
  receiver.open();
  const Stage stage(kPrivate);
  const HttpClient client = stage.client();
  for (const char* path : {"/fine", "/gone", "/silent", "/busy"}) {
    CAPTURE(path);
    const std::string job = submit_with(client, receiver.url(path));
    walk.see(ask(walk, stage, job + "/deliveries"));
    const Json delivery = delivery_once(client, job, was_tried);
    walk.see(ask(walk, stage, job + "/deliveries"));
    CHECK(delivery["attempts"][0].contains("error") == (path == std::string("/silent")));
  }
  const std::string untold = submit(client, noisy_torus(10));
  const Answer none = ask(walk, stage, untold + "/deliveries");
  walk.see(none);
  CHECK(none.json()["deliveries"].empty());
  check_head(walk, stage, untold + "/deliveries");
  see_job_refusals(walk, stage);
}

void walk_redeliver(ContractWalk& walk) {
  WebhookReceiver receiver(answer_by_path);
  receiver.open();
  const Stage stage(kPrivate);
  const HttpClient client = stage.client();
  for (const char* path : {"/fine", "/gone"}) {
    CAPTURE(path);
    const std::string job = submit_with(client, receiver.url(path));
    const Json delivery = delivery_once(client, job, was_tried);
    const Answer asked = ask(walk, stage, delivery["links"]["redeliver"]);
    walk.see(asked);
    CHECK(asked.status == 202);
    const Answer unknown = ask(walk, stage, job + "/deliveries/msg_other/redeliver");
    walk.see(unknown);
    CHECK(unknown.problem() == "not_found");
  }
  see_job_refusals(walk, stage);
}

}  // namespace fairway::test
