// Whom webhooks may reach, who may hold them up, and what they give away.
#include <atomic>
#include <fstream>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <httplib.h>

#include "tests/service/webhooks/webhook_fixture.h"

using namespace fairway;
using namespace fairway::test;

TEST_CASE("addresses that are not public are refused unless they are allowed, names too") {
  const TemporaryDirectory directory;
  WebhookReceiver receiver;
  receiver.open();
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  for (const char* host : {"127.0.0.1", "localhost", "0.0.0.0", "2130706433", "0x7f.1", "[::1]",
                           "[::ffff:127.0.0.1]"}) {
    CAPTURE(host);
    const std::string path = submit_with(client, receiver.url("/hook", host));
    const Json delivery =
        delivery_once(client, path, [](const Json& each) { return !each["attempts"].empty(); });
    CHECK(delivery["state"] == "pending");
    CHECK_FALSE(delivery["attempts"][0].contains("status"));
    CHECK(delivery["attempts"][0]["error"].get<std::string>().find("no public address") !=
          std::string::npos);
  }
  // The same is told where it is allowed; it is the first to arrive.
  const TemporaryDirectory other;
  const ServiceProcess allowing(other.path(), kPrivate);
  submit_with(allowing.client(), receiver.url("/allowed", "localhost"));
  CHECK(receiver.wait_for(1).front().target == "/allowed");
}

TEST_CASE("a certificate that no authority vouches for is not trusted") {
  const TemporaryDirectory directory;
  const std::string place = directory.path().string();
  said("openssl req -x509 -newkey rsa:2048 -nodes -days 1 -subj /CN=localhost -keyout " + place +
       "/key.pem -out " + place + "/cert.pem 2>&1");
  httplib::SSLServer receiver((place + "/cert.pem").c_str(), (place + "/key.pem").c_str());
  std::atomic<int> received = 0;
  receiver.Post("/hook", [&](const httplib::Request&, httplib::Response&) { ++received; });
  const int port = receiver.bind_to_any_port("127.0.0.1");
  REQUIRE(port > 0);
  std::thread thread([&] { receiver.listen_after_bind(); });
  {
    const ServiceProcess service(directory.path() / "data", kPrivate);
    const HttpClient client = service.client();
    const std::string path =
        submit_with(client, "https://localhost:" + std::to_string(port) + "/hook");
    const Json delivery =
        delivery_once(client, path, [](const Json& each) { return !each["attempts"].empty(); });
    CHECK(delivery["state"] == "pending");
    CHECK(delivery["attempts"][0]["error"].get<std::string>().starts_with("TLS failed"));
    CHECK(received == 0);
  }
  receiver.stop();
  thread.join();
}

TEST_CASE("an endpoint that does not answer does not hold up another") {
  const TemporaryDirectory directory;
  Latch latch;
  WebhookReceiver slow([&](const Received&, std::size_t) {
    latch.wait();
    return answer_of(200);
  });
  const Latch::OpenedAtEnd end(latch);
  WebhookReceiver fast;
  slow.open();
  fast.open();
  const ServiceProcess service(directory.path(), kPrivate);
  const HttpClient client = service.client();
  std::vector<std::string> waiting(8);
  for (std::string& path : waiting) path = submit_with(client, slow.url());
  slow.wait_for(4);
  for (const std::string& path : waiting) wait_until_final(client, path);
  const std::string path = submit_with(client, fast.url());
  delivery_once(client, path, is("delivered"));
  // More than four at a time are not sent to one endpoint.
  CHECK(slow.wait_for(4).size() == 4);
  for (const std::string& held : waiting) {
    CHECK(client.get(held + "/deliveries").json()["deliveries"][0]["attempts"].empty());
  }
  latch.open();
  for (const std::string& held : waiting) delivery_once(client, held, is("delivered"));
}

TEST_CASE("a new secret and the one before it both sign") {
  const TemporaryDirectory directory;
  WebhookReceiver receiver;
  receiver.open();
  const ServiceProcess service(directory.path(), kPrivate);
  const HttpClient client = service.client();
  const std::string old_secret = secret_of(directory);
  const std::string new_secret = secret_of(directory, "rotate");
  CHECK(old_secret != new_secret);
  CHECK(secret_of(directory) == new_secret);
  submit_with(client, receiver.url());
  const Received post = receiver.wait_for(1).front();
  CHECK(post.headers.at("webhook-signature") ==
        expected_signature(new_secret, post) + " " + expected_signature(old_secret, post));
}

TEST_CASE("a command about secrets that cannot be meant is refused") {
  const TemporaryDirectory directory;
  const std::string data = directory.path().string();
  const auto refused = [](std::vector<std::string> words) {
    words.insert(words.begin(), "webhooks");
    return refused_start(words);
  };
  CHECK(refused({}).status.code == 2);
  CHECK(refused({"secret", "print", "--data", data}).status.code == 2);
  CHECK(refused({"secret", "show"}).text.find("--data") != std::string::npos);
  CHECK(refused({"secret", "show", "--tenant"}).status.code == 2);
  CHECK(refused({"secret", "show", "--data", data}).text.find("that has run") != std::string::npos);
  CHECK(std::filesystem::is_empty(directory.path()));
  { ServiceProcess(directory.path()).stop(); }
  CHECK(refused({"secret", "show", "--data", data, "--tenant", "nobody"}).text.find("no tenant") !=
        std::string::npos);
}

TEST_CASE("a URL that cannot be a webhook's is refused with its place") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  for (const char* url : {"ftp://example.com/", "https://me@example.com/", "https://h/#f", ""}) {
    CAPTURE(url);
    const Answer answer =
        client.post("/v1/jobs?webhook=" + percent_encoded(url), small_glb(), kGlbType);
    CHECK(answer.status == 422);
    CHECK(answer.problem() == "invalid_parameters");
    CHECK(answer.json()["pointer"] == "/webhook/url");
  }
  CHECK(client
            .post("/v1/jobs?webhook=https%3A%2F%2Fa%2F&webhook=https%3A%2F%2Fb%2F", small_glb(),
                  kGlbType)
            .problem() == "bad_request");
  CHECK(client.get("/v1/jobs").json()["jobs"].empty());
}

TEST_CASE("webhooks are counted and logged, without secrets") {
  const TemporaryDirectory directory;
  const TemporaryDirectory logs;
  WebhookReceiver receiver([](const Received& post, std::size_t) {
    return answer_of(post.target == "/bad" ? 500 : 200);
  });
  receiver.open();
  const std::filesystem::path log = logs.path() / "log";
  const ServiceProcess service(directory.path(), kPrivate, log);
  const HttpClient client = service.client();
  const std::string good = submit_with(client, receiver.url("/good?token=secret-word"));
  delivery_once(client, good, is("delivered"));
  const std::string bad = submit_with(client, receiver.url("/bad"));
  delivery_once(client, bad, [](const Json& each) { return !each["attempts"].empty(); });
  std::string metrics;
  const std::string put_off = "fairway_webhook_attempts_total{outcome=\"retried\"} 1\n";
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (metrics.find(put_off) == std::string::npos && std::chrono::steady_clock::now() < until) {
    metrics = client.get("/metrics").body;
  }
  CHECK(metrics.find(put_off) != std::string::npos);
  CHECK(metrics.find("fairway_webhook_attempts_total{outcome=\"delivered\"} 1\n") !=
        std::string::npos);
  CHECK(metrics.find("fairway_webhook_deliveries_pending 1\n") != std::string::npos);
  CHECK(metrics.find("\nfairway_webhook_oldest_pending_age_seconds ") != std::string::npos);

  const std::string secret = secret_of(directory);
  const std::string id = client.get(good).json()["id"];
  bool told = false;
  std::ifstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    CHECK(line.find(secret) == std::string::npos);
    CHECK(line.find("secret-word") == std::string::npos);
    const auto entry = parse_json(line);
    REQUIRE(entry);
    if ((*entry)["event"] != "webhook_delivered") continue;
    told = true;
    CHECK((*entry)["job"] == id);
    CHECK((*entry)["trace"].get<std::string>().size() == 32);
    CHECK((*entry)["origin"] == receiver.url(""));
    CHECK((*entry)["answer"] == 200);
  }
  CHECK(told);
}
