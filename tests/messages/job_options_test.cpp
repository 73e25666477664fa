#include "proto/messages/job_options.h"

#include <catch2/catch.hpp>

namespace fairway::test {
namespace {

Error refusal(const std::string& text) {
  const auto options = parse_job_options(text);
  REQUIRE_FALSE(options);
  return options.error();
}

}  // namespace

TEST_CASE("nothing is asked of a job by default") {
  const auto options = parse_job_options("");
  REQUIRE(options);
  CHECK(options->labels.empty());
  CHECK(options->priority == 0);
  CHECK_FALSE(options->ttl);
  CHECK(job_options_document(*options) == Json::object());
}

TEST_CASE("options read back as they are told, labels in order and once") {
  const auto options = parse_job_options(
      R"({"labels":["b","batch:7","b"],"priority":-10,"ttl":60,"deadline":86400})");
  REQUIRE(options);
  CHECK(options->labels == std::vector<std::string>{"b", "batch:7"});
  CHECK(options->priority == -10);
  CHECK(options->ttl == std::chrono::minutes(1));
  CHECK(options->deadline == std::chrono::hours(24));
  const auto again = parse_job_options(job_options_document(*options).dump());
  REQUIRE(again);
  CHECK(job_options_document(*again) == job_options_document(*options));
}

TEST_CASE("options out of range are refused with their place") {
  CHECK(refusal(R"({"priority":11})").pointer == "/priority");
  CHECK(refusal(R"({"ttl":59})").pointer == "/ttl");
  CHECK(refusal(R"({"deadline":0})").pointer == "/deadline");
  CHECK(refusal(R"({"labels":["ok","not ok"]})").pointer == "/labels/1");
  CHECK(refusal(R"({"colour":1})").pointer == "/colour");
  CHECK(refusal("[]").code == ErrorCode::invalid_parameters);
  CHECK(refusal("{").code == ErrorCode::malformed_parameters);
  std::string many = R"({"labels":["0")";
  for (std::size_t i = 1; i <= kMaxLabels; ++i) many += ",\"" + std::to_string(i) + '"';
  CHECK(refusal(many + "]}").pointer == "/labels/16");
}

TEST_CASE("a label is a short word of plain characters") {
  CHECK(is_label("batch:2024-05_a/b@c+d=e.f"));
  CHECK(is_label(std::string(kMaxLabelBytes, 'x')));
  CHECK_FALSE(is_label(std::string(kMaxLabelBytes + 1, 'x')));
  CHECK_FALSE(is_label(""));
  CHECK_FALSE(is_label("a b"));
  CHECK_FALSE(is_label("ä"));
  CHECK_FALSE(is_label("a\n"));
}

}  // namespace fairway::test
