#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include "tests/places.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/service/webhooks/webhook_receiver.h"

namespace fairway::test {

inline constexpr const char* kGlbType = "model/gltf-binary";
inline const std::vector<std::string> kPrivate = {"--webhook-allow-private", "yes"};
/// As fast as it gets: the retries' first delay is about a second.
inline const std::vector<std::string> kQuick = {"--webhook-allow-private", "yes", "--webhook-retry",
                                                "1"};

/// Submits a small mesh; returns the job's path.
inline std::string submit_with(const HttpClient& client, const std::string& url,
                               const std::string& label = "any") {
  const Answer answer = client.post("/v1/jobs?label=" + label + "&webhook=" + percent_encoded(url),
                                    small_glb(), kGlbType, {{"Cache-Control", "no-cache"}});
  CAPTURE(answer.body);
  REQUIRE(answer.status == 202);
  return answer.header("location");
}

/// The newest delivery of a job, once `enough` says so.
template <class Enough>
Json delivery_once(const HttpClient& client, const std::string& path, const Enough& enough) {
  return follow(client, path + "/deliveries", [&](const Json& list) {
    return !list["deliveries"].empty() && enough(list["deliveries"][0]);
  })["deliveries"][0];
}

inline auto is(const char* state) {
  return [state](const Json& delivery) { return delivery["state"] == state; };
}

/// What the program says on its standard output.
inline std::string said(const std::string& command) {
  FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string text;
  std::array<char, 1000> chunk;
  while (std::fgets(chunk.data(), chunk.size(), pipe) != nullptr) text += chunk.data();
  CHECK(::pclose(pipe) == 0);
  return text;
}

inline std::string secret_of(const TemporaryDirectory& directory,
                             const std::string& verb = "show") {
  const std::string text = said(program("fairwayd") + " webhooks secret " + verb + " --data " +
                                directory.path().string() + " 2>/dev/null");
  REQUIRE(text.starts_with("whsec_"));
  REQUIRE(text.ends_with("\n"));
  return text.substr(0, text.size() - 1);
}

/// "v1,…" computed with OpenSSL, from what arrived.
inline std::string expected_signature(const std::string& secret, const Received& post) {
  const std::string base64 = secret.substr(std::string("whsec_").size());
  std::array<unsigned char, 64> key{};
  const auto* text = reinterpret_cast<const unsigned char*>(base64.data());
  REQUIRE(EVP_DecodeBlock(key.data(), text, static_cast<int>(base64.size())) == 33);
  const std::string content =
      post.id() + "." + post.headers.at("webhook-timestamp") + "." + post.body;
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  HMAC(EVP_sha256(), key.data(), 32, reinterpret_cast<const unsigned char*>(content.data()),
       content.size(), digest.data(), &size);
  std::array<unsigned char, 100> encoded{};
  const int length = EVP_EncodeBlock(encoded.data(), digest.data(), static_cast<int>(size));
  return "v1," + std::string(encoded.begin(), encoded.begin() + length);
}

}  // namespace fairway::test
