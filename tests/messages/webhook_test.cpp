// The URL of a webhook and what it is told.
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "proto/messages/job_options.h"
#include "proto/messages/webhook_event.h"
#include "proto/messages/webhook_url.h"
#include "tests/messages/json_schema.h"

namespace fairway::test {

TEST_CASE("the URL of a webhook is absolute, of http, with a host") {
  for (const char* url :
       {"https://example.com", "http://example.com:8080/a/b?token=x%20y&z=[1]@", "HTTPS://h/",
        "http://127.0.0.1/", "http://[2001:db8::1]:80/x", "https://a_b.example./?"}) {
    CAPTURE(url);
    CHECK(webhook_url_complaint(url).empty());
  }
}

TEST_CASE("a URL that a webhook cannot have is refused with what to do") {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "must begin with https:// or http://"},
      {"example.com/hook", "must begin with https:// or http://"},
      {"ftp://example.com/", "must begin with https:// or http://"},
      {"file:///etc/passwd", "must begin with https:// or http://"},
      {"https://example.com/" + std::string(kMaxWebhookUrlBytes, 'x'), "at most 2048"},
      {"https://example.com/a b", "percent-encode"},
      {"https://example.com/\r\nHost: x", "percent-encode"},
      {"https://ex\xc3\xa4mple.com/", "percent-encode"},
      {"https://example.com\\@evil.com/", "percent-encode"},
      {"https://example.com/#top", "no fragment"},
      {"https://me:word@example.com/", "no user name"},
      {"https://@example.com/", "no user name"},
      {"https://", "must name a host"},
      {"https:///x", "must name a host"},
      {"https://?x", "must name a host"},
      {"https://[::1", "must name a host"},
      {"https://[fe80::1%25eth0]/", "must name a host"},
      {"https://ex%61mple.com/", "must name a host"},
      {"https://example.com:/", "must have a port"},
      {"https://example.com:0/", "must have a port"},
      {"https://example.com:65536/", "must have a port"},
      {"https://example.com:80:80/", "must have a port"},
  };
  for (const auto& [url, complaint] : cases) {
    CAPTURE(url);
    CHECK_THAT(webhook_url_complaint(url), Catch::Contains(complaint));
  }
}

TEST_CASE(
    "the pattern of a URL holds for every URL that is taken, and for no other but of a port") {
  const Json schema = job_options_schema()["properties"]["webhook"]["properties"]["url"];
  for (const auto& [url, taken] : std::vector<std::pair<std::string, bool>>{
           {"https://example.com", true},
           {"http://example.com:8080/a/b?token=x%20y&z=[1]@'", true},
           {"HTTPS://h/", true},
           {"http://[2001:db8::1]:80/x", true},
           {"https://a_b.example./?", true},
           {"https://h?x/y", true},
           {"https://h/" + std::string(kMaxWebhookUrlBytes - 10, 'x'), true},
           {"https://h/" + std::string(kMaxWebhookUrlBytes - 9, 'x'), false},
           {"ftp://example.com/", false},
           {"https://example.com/a b", false},
           {"https://example.com/#top", false},
           {"https://me:word@example.com/", false},
           {"https:///x", false},
           {"https://[::1", false},
           {"https://ex%61mple.com/", false},
           {"https://example.com:/", false},
           {"https://example.com:80:80/", false}}) {
    CAPTURE(url);
    CHECK(webhook_url_complaint(url).empty() == taken);
    CHECK(schema_fault(Json(url), schema, schema).empty() == taken);
  }
  const Json options = job_options_schema();
  CHECK_FALSE(schema_fault(Json{{"webhook", {{"secret", "x"}}}}, options, options).empty());
}

TEST_CASE("a URL is shown without its query, and belongs to its origin") {
  CHECK(shown_url("https://h/p?token=secret") == "https://h/p?…");
  CHECK(shown_url("https://h/p") == "https://h/p");
  CHECK(origin_of_url("HTTPS://Example.COM:8443/Hook?a") == "https://example.com:8443");
  CHECK(origin_of_url("http://h?x/y") == "http://h");
}

TEST_CASE("a job's webhook is read strictly and reads back") {
  const auto options = parse_job_options(R"({"webhook":{"url":"https://h/p?token=t"}})");
  REQUIRE(options);
  REQUIRE(options->webhook);
  CHECK(options->webhook->url == "https://h/p?token=t");
  const auto again = parse_job_options(job_options_document(*options).dump());
  REQUIRE(again);
  CHECK(again->webhook->url == options->webhook->url);

  const auto pointer = [](const std::string& text) {
    const auto refused = parse_job_options(text);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::invalid_parameters);
    return refused.error().pointer;
  };
  CHECK(pointer(R"({"webhook":"https://h/"})") == "/webhook");
  CHECK(pointer(R"({"webhook":null})") == "/webhook");
  CHECK(pointer(R"({"webhook":{}})") == "/webhook/url");
  CHECK(pointer(R"({"webhook":{"url":7}})") == "/webhook/url");
  CHECK(pointer(R"({"webhook":{"url":"h"}})") == "/webhook/url");
  CHECK(pointer(R"({"webhook":{"url":"https://h/","secret":"x"}})") == "/webhook/secret");
}

TEST_CASE("an event tells the end of a job without its long documents and secrets") {
  JobFacts job;
  job.id = "x";
  job.state = JobState::succeeded;
  job.finished = 1000;
  job.options.labels = {"red"};
  job.options.webhook = Webhook{"https://h/p?token=secret"};
  job.report = Json{{"surfaces", 1}};
  job.parameters = Json{{"steps", 3}};
  job.result = PayloadFacts{Format::glb, 12, "ab"};
  const Json event = webhook_event(job);
  CHECK(event["type"] == "job.succeeded");
  CHECK(event["timestamp"] == "1970-01-01T00:00:01.000Z");
  const Json& data = event["data"];
  CHECK(data["id"] == "x");
  CHECK(data["state"] == "succeeded");
  CHECK(data["labels"] == Json({"red"}));
  CHECK(data["result"]["sha256"] == "ab");
  CHECK(data["links"]["deliveries"] == "/v1/jobs/x/deliveries");
  CHECK_FALSE(data.contains("report"));
  CHECK_FALSE(data.contains("parameters"));
  CHECK(event.dump().find("secret") == std::string::npos);

  job.state = JobState::failed;
  job.problem = Error{ErrorCode::no_triangles, "There is nothing to denoise."};
  CHECK(webhook_event(job)["type"] == "job.failed");
  CHECK(webhook_event(job)["data"]["problem"]["code"] == "no_triangles");
}

}  // namespace fairway::test
