// What webhooks are told, as the contract says it.

#include <map>
#include <set>
#include <string>

#include <catch2/catch.hpp>

#include "proto/messages/openapi.h"
#include "tests/messages/json_schema.h"
#include "tests/service/contract/contract_walks.h"
#include "tests/service/webhooks/webhook_fixture.h"

namespace fairway::test {
namespace {

/// Headers of the message itself, which need no document.
const std::set<std::string> kFraming = {"host", "accept", "content-type", "content-length"};

void check_fits(const Json& value, const Json& schema, const Json& document) {
  const std::string fault = schema_fault(value, schema, document);
  CAPTURE(fault);
  CHECK(fault.empty());
}

/// Holds a POST against its document, and returns its event.
Json checked(const Received& post, const Json& operation, const Json& document) {
  std::set<std::string> documented = kFraming;
  for (const Json& given : operation["parameters"]) {
    const Json header = resolved(document, given);
    const std::string name = header["name"];
    CAPTURE(name);
    CHECK(header["in"] == "header");
    CHECK(header["required"] == true);
    documented.insert(name);
    REQUIRE(post.headers.contains(name));
    check_fits(post.headers.at(name), header["schema"], document);
  }
  for (const auto& [name, value] : post.headers) {
    CAPTURE(name, value);
    if (!documented.contains(name)) FAIL_CHECK("an undocumented header came");
  }
  const Json& content = operation["requestBody"]["content"];
  REQUIRE(content.size() == 1);
  CHECK(content.contains(post.headers.at("content-type")));
  const auto event = parse_json(post.body);
  REQUIRE(event);
  check_fits(*event, content.front()["schema"], document);
  return *event;
}

}  // namespace

TEST_CASE("a webhook is told every documented event as it is documented, and no other") {
  const Json document = openapi_document();
  REQUIRE(document["webhooks"].size() == 1);
  const Json operation = document["webhooks"]["jobEnded"]["post"];
  std::set<std::string> documented;
  for (const Json& example : operation["requestBody"]["content"]["application/json"]["examples"]) {
    documented.insert(resolved(document, example)["value"]["type"]);
  }
  WebhookReceiver receiver;
  receiver.open();
  const Stage stage({"--webhook-allow-private", "yes", "--workers", "1"});
  const HttpClient client = stage.client();
  const std::string query = "/v1/jobs?label=red&ttl=600&webhook=" + percent_encoded(receiver.url());
  REQUIRE(client.post(query, small_glb(Flaw::not_a_number), kGlbType).status == 202);
  receiver.wait_for(1);
  const Answer made = client.post(query, noisy_torus(10), kGlbType);
  wait_until_final(client, made.header("location"));
  receiver.wait_for(2);
  REQUIRE(client.post(query, noisy_torus(10), kGlbType).json()["cached"] == true);
  receiver.wait_for(3);
  const std::string endless = "&params=" + percent_encoded(kEndless);
  const Answer busy = client.post(query + endless, noisy_torus(300), kGlbType);
  wait_until_busy(client, busy.header("location"));
  const Answer waits = client.post(query + "&priority=3", small_glb(), kGlbType);
  for (const Answer* one : {&waits, &busy}) {
    REQUIRE(client.post(one->header("location") + "/cancel").status == 200);
  }
  std::set<std::string> seen;
  for (const Received& post : receiver.wait_for(5)) {
    seen.insert(checked(post, operation, document)["type"]);
  }
  CHECK(seen == documented);
}

TEST_CASE("a webhook's answers mean what is documented") {
  const Json answers = openapi_document()["webhooks"]["jobEnded"]["post"]["responses"];
  const std::map<std::string, std::pair<int, const char*>> meant = {
      {"2XX", {200, "delivered"}}, {"410", {410, "dead"}}, {"default", {302, "pending"}}};
  for (const auto& [status, answer] : answers.items()) {
    CAPTURE(status);
    REQUIRE(meant.contains(status));
    const auto& [given, state] = meant.at(status);
    WebhookReceiver receiver(
        [code = given](const Received&, std::size_t) { return answer_of(code); });
    receiver.open();
    const Stage stage(kPrivate);
    const std::string job = submit_with(stage.client(), receiver.url());
    const Json delivery = delivery_once(stage.client(), job,
                                        [](const Json& each) { return !each["attempts"].empty(); });
    CHECK(delivery["state"] == state);
  }
  CHECK(answers.size() == meant.size());
}

}  // namespace fairway::test
