#include "server/fairwayd/webhooks/webhook_signature.h"

#include <set>
#include <vector>

#include <catch2/catch.hpp>

#include "server/fairwayd/store/webhook_secret.h"
#include "server/os/hmac.h"

using namespace fairway;

TEST_CASE("a signature is the one that the specification's libraries compute") {
  // The example of the reference implementations' tests.
  const std::vector<std::string> secrets = {"whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"};
  CHECK(webhook_signature(secrets, "msg_p5jXN8AQM9LWM0D4loKWxJek", 1614265330,
                          R"({"test": 2432232314})") ==
        "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=");
}

TEST_CASE("an HMAC is that of RFC 4231") {
  // Case 2: the key "Jefe".
  CHECK(hmac_sha256("SmVmZQ==", "what do ya want for nothing?") ==
        "W9zBRr9gdU5qBCQmCJV1x1oAPwidJzmDnexYuWTsOEM=");
  CHECK_FALSE(hmac_sha256("", "x"));
  CHECK_FALSE(hmac_sha256("SmV", "x"));
  CHECK_FALSE(hmac_sha256("S*Vm", "x"));
}

TEST_CASE("each secret signs, separated by spaces, the first one first") {
  const std::vector<std::string> secrets = {new_webhook_secret(), new_webhook_secret()};
  const std::string both = webhook_signature(secrets, "m", 1, "{}");
  CHECK(both == webhook_signature(std::span(secrets).first(1), "m", 1, "{}") + " " +
                    webhook_signature(std::span(secrets).last(1), "m", 1, "{}"));
  CHECK(webhook_signature(std::vector<std::string>{"plain", "whsec_*"}, "m", 1, "{}").empty());
}

TEST_CASE("secrets are of 32 random bytes, no two the same") {
  std::set<std::string> seen;
  for (int i = 0; i < 100; ++i) seen.insert(new_webhook_secret());
  CHECK(seen.size() == 100);
  CHECK(seen.begin()->starts_with("whsec_"));
  CHECK(seen.begin()->size() == 6 + 44);
}
