// Webhooks from the submit to a receiver, with the real service.
#include <string>

#include <catch2/catch.hpp>

#include "server/fairwayd/telemetry/clocks.h"
#include "tests/service/webhooks/webhook_fixture.h"

using namespace fairway;
using namespace fairway::test;

TEST_CASE("a webhook is told the end of its job once, signed") {
  const TemporaryDirectory directory;
  WebhookReceiver receiver;
  receiver.open();
  const ServiceProcess service(directory.path(), kPrivate);
  const HttpClient client = service.client();
  const std::string path = submit_with(client, receiver.url("/hook?token=t"), "red");
  const Json delivery = delivery_once(client, path, is("delivered"));
  const auto posts = receiver.wait_for(1);
  REQUIRE(posts.size() == 1);
  const Received& post = posts.front();
  CHECK(post.target == "/hook?token=t");
  CHECK(delivery["id"] == post.id());
  CHECK(post.headers.at("content-type") == "application/json");
  CHECK(post.headers.at("webhook-signature") == expected_signature(secret_of(directory), post));

  const auto event = parse_json(post.body);
  REQUIRE(event);
  const Json job = client.get(path).json();
  CHECK((*event)["type"] == "job.succeeded");
  CHECK((*event)["timestamp"] == job["finished"]);
  const Json& data = (*event)["data"];
  for (const char* key : {"id", "state", "revision", "labels", "links", "result", "webhook"}) {
    CAPTURE(key);
    CHECK(data[key] == job[key]);
  }
  CHECK(job["webhook"]["url"] == receiver.url("/hook?…"));
  CHECK(job["links"]["deliveries"] == path + "/deliveries");
  CHECK_FALSE(data.contains("report"));

  CHECK(delivery["event"] == "job.succeeded");
  CHECK(delivery["url"] == receiver.url("/hook?…"));
  CHECK_FALSE(delivery.contains("next_at"));
  REQUIRE(delivery["attempts"].size() == 1);
  CHECK(delivery["attempts"][0]["status"] == 204);
  CHECK(receiver.wait_for(1).size() == 1);
}

TEST_CASE("a failed and a canceled job are told as such, the webhook named in a part") {
  const TemporaryDirectory directory;
  WebhookReceiver receiver;
  receiver.open();
  const ServiceProcess service(directory.path(), kPrivate);
  const HttpClient client = service.client();
  const std::string webhook = "&webhook=" + percent_encoded(receiver.url());
  const Answer failing =
      client.post("/v1/jobs?label=a" + webhook, small_glb(Flaw::not_a_number), kGlbType);
  REQUIRE(failing.status == 202);
  const auto failed = parse_json(receiver.wait_for(1).front().body);
  REQUIRE(failed);
  CHECK((*failed)["type"] == "job.failed");
  CHECK((*failed)["data"]["problem"]["code"] == "invalid_mesh");

  const std::string form =
      "--b\r\nContent-Disposition: form-data; name=\"job\"\r\n\r\n{\"webhook\":{\"url\":\"" +
      receiver.url("/part") +
      "\"}}\r\n--b\r\nContent-Disposition: form-data; name=\"params\"\r\n\r\n{\"steps\":10000}"
      "\r\n--b\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"m.glb\"\r\n\r\n" +
      noisy_torus(100) + "\r\n--b--\r\n";
  const Answer answer = client.post("/v1/jobs", form, "multipart/form-data; boundary=b");
  CAPTURE(answer.body);
  REQUIRE(answer.status == 202);
  REQUIRE(client.remove(answer.header("location")).json()["state"] == "expired");
  const Received told = receiver.wait_for(2).back();
  CHECK(told.target == "/part");
  CHECK(parse_json(told.body)->at("type") == "job.canceled");
}

TEST_CASE("an endpoint that is down is told once it is up, and errors are tried again") {
  const TemporaryDirectory directory;
  WebhookReceiver receiver(
      [](const Received&, std::size_t n) { return answer_of(n == 0 ? 500 : 200); });
  const ServiceProcess service(directory.path(), kQuick);
  const HttpClient client = service.client();
  const std::string path = submit_with(client, receiver.url());
  const Json down = delivery_once(
      client, path, [](const Json& delivery) { return !delivery["attempts"].empty(); });
  CHECK(down["state"] == "pending");
  CHECK(down.contains("next_at"));
  CHECK_FALSE(down["attempts"][0].contains("status"));
  CHECK(down["attempts"][0]["error"].get<std::string>().find("refused") != std::string::npos);
  receiver.open();
  // The third attempt would come after a minute: it is asked for.
  const std::string first = receiver.wait_for(1).front().id();
  delivery_once(client, path,
                [](const Json& delivery) { return delivery["attempts"].size() == 2; });
  CHECK(client.post(down["links"]["redeliver"]).status == 202);
  const Json delivery = delivery_once(client, path, is("delivered"));
  REQUIRE(delivery["attempts"].size() == 3);
  CHECK(delivery["attempts"][1]["status"] == 500);
  CHECK(delivery["attempts"][2]["status"] == 200);
  CHECK(receiver.wait_for(2).back().id() == first);
}

TEST_CASE("what a killed server had to tell is told after its restart, under the same id") {
  const TemporaryDirectory directory;
  Latch latch;
  WebhookReceiver receiver(first_one_waits(latch));
  const Latch::OpenedAtEnd end(latch);
  receiver.open();
  std::string path;
  std::string id;
  {
    ServiceProcess service(directory.path(), kPrivate);
    path = submit_with(service.client(), receiver.url());
    id = receiver.wait_for(1).front().id();
    service.kill();
  }
  latch.open();
  const ServiceProcess service(directory.path(), kPrivate);
  const auto posts = receiver.wait_for(2);
  CHECK(posts.back().id() == id);
  CHECK(posts.back().body == posts.front().body);
  const Json delivery = delivery_once(service.client(), path, is("delivered"));
  CHECK(delivery["id"] == id);
  CHECK(delivery["attempts"].size() == 1);
}

TEST_CASE("a stopped server hands back what is on its way, without waiting for it") {
  const TemporaryDirectory directory;
  Latch latch;
  WebhookReceiver receiver(first_one_waits(latch));
  const Latch::OpenedAtEnd end(latch);
  receiver.open();
  std::string path;
  {
    ServiceProcess service(directory.path(), kPrivate);
    path = submit_with(service.client(), receiver.url());
    receiver.wait_for(1);
    CHECK(service.stop().code == 0);
  }
  latch.open();
  const ServiceProcess service(directory.path(), kPrivate);
  CHECK(delivery_once(service.client(), path, is("delivered"))["attempts"].size() == 1);
  CHECK(receiver.wait_for(2).size() == 2);
}

TEST_CASE("410 is the end, and a redirect is not followed") {
  const TemporaryDirectory directory;
  WebhookReceiver elsewhere;
  elsewhere.open();
  const std::string location = "Location: " + elsewhere.url() + "\r\n";
  WebhookReceiver receiver([&](const Received& post, std::size_t) {
    return post.target == "/gone" ? answer_of(410) : answer_of(307, location);
  });
  receiver.open();
  const ServiceProcess service(directory.path(), kPrivate);
  const HttpClient client = service.client();
  const std::string gone = submit_with(client, receiver.url("/gone"));
  const Json dead = delivery_once(client, gone, is("dead"));
  CHECK(dead["attempts"].size() == 1);
  CHECK(dead["attempts"][0]["status"] == 410);
  const std::string moved = submit_with(client, receiver.url("/moved"));
  const Json pending = delivery_once(
      client, moved, [](const Json& delivery) { return !delivery["attempts"].empty(); });
  CHECK(pending["state"] == "pending");
  CHECK(pending["attempts"][0]["status"] == 307);
  // Whatever follows arrives after what would have been sent on.
  submit_with(client, elsewhere.url("/last"));
  CHECK(elsewhere.wait_for(1).front().target == "/last");
}

TEST_CASE("an endpoint that asks for time gets it") {
  const TemporaryDirectory directory;
  WebhookReceiver receiver(
      [](const Received&, std::size_t) { return answer_of(503, "Retry-After: 3600\r\n"); });
  receiver.open();
  const ServiceProcess service(directory.path(), kPrivate);
  const HttpClient client = service.client();
  const std::string path = submit_with(client, receiver.url());
  const Json delivery =
      delivery_once(client, path, [](const Json& each) { return !each["attempts"].empty(); });
  constexpr UnixMillis kHour = 3'600'000;
  CHECK(delivery["next_at"] > rfc3339_utc(wall_clock() + kHour / 2));
  CHECK(delivery["next_at"] <= rfc3339_utc(wall_clock() + kHour));
}

TEST_CASE("a webhook that fails to the end of its schedule is dead") {
  const TemporaryDirectory directory;
  WebhookReceiver receiver([](const Received&, std::size_t) { return answer_of(500); });
  receiver.open();
  const ServiceProcess service(directory.path(),
                               {"--webhook-allow-private", "yes", "--webhook-retry", "0"});
  const HttpClient client = service.client();
  const std::string path = submit_with(client, receiver.url());
  const Json dead = delivery_once(client, path, is("dead"));
  CHECK(dead["attempts"].size() == 10);
  CHECK(receiver.wait_for(10).size() == 10);
}

TEST_CASE("a delivery is sent again when it is asked for") {
  const TemporaryDirectory directory;
  WebhookReceiver receiver;
  receiver.open();
  const ServiceProcess service(directory.path(), kPrivate);
  const HttpClient client = service.client();
  const std::string path = submit_with(client, receiver.url());
  const Json first = delivery_once(client, path, is("delivered"));
  const Answer asked = client.post(first["links"]["redeliver"]);
  CHECK(asked.status == 202);
  CHECK(asked.json()["state"] == "pending");
  const auto posts = receiver.wait_for(2);
  CHECK(posts[1].id() == posts[0].id());
  CHECK(posts[1].body == posts[0].body);
  delivery_once(client, path, [](const Json& each) {
    return each["state"] == "delivered" && each["attempts"].size() == 2;
  });
  CHECK(client.post(path + "/deliveries/msg_other/redeliver").problem() == "not_found");
  CHECK(client.get("/v1/jobs/unknown/deliveries").problem() == "not_found");
  const std::string other = submit(client, small_glb(), R"({"steps":2})");
  CHECK(client.get(other + "/deliveries").json()["deliveries"].empty());
  CHECK_FALSE(client.get(other).json()["links"].contains("deliveries"));
  CHECK(client.post(other + "/deliveries/" + posts[0].id() + "/redeliver").status == 404);
}
