#include "server/fairwayd/settings.h"

#include <vector>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

Result<Settings> parse(const std::vector<const char*>& arguments) {
  return parse_settings(arguments);
}

}  // namespace

TEST_CASE("every option reaches its setting") {
  const auto settings =
      parse({"--data", "d", "--listen", "[::1]:0", "--workers", "3", "--queue", "4", "--max-body",
             "5", "--deadline", "6", "--worker-memory", "7", "--worker", "w"});
  REQUIRE(settings);
  CHECK(settings->data == "d");
  CHECK(settings->listen.host == "::1");
  CHECK(settings->listen.port == 0);
  CHECK(settings->workers == 3);
  CHECK(settings->queue == 4);
  CHECK(settings->max_body == 5);
  CHECK(settings->deadline.count() == 6);
  CHECK(settings->worker_memory == 7);
  CHECK(settings->worker == "w");
}

TEST_CASE("a command line that cannot be meant is refused") {
  const std::vector<std::vector<const char*>> broken = {
      {},
      {"--data"},
      {"--data", "d", "extra"},
      {"--data", "d", "--what", "1"},
      {"--data", "d", "--workers", "0"},
      {"--data", "d", "--workers", "-1"},
      {"--data", "d", "--queue", "1x"},
      {"--data", "d", "--listen", "8080"},
      {"--data", "d", "--listen", "host:99999"},
      {"--data", "d", "--listen", ":80"},
  };
  for (const auto& arguments : broken) {
    const auto settings = parse(arguments);
    REQUIRE_FALSE(settings);
    CHECK(settings.error().code == ErrorCode::usage);
  }
}

TEST_CASE("help and version need nothing else") {
  CHECK(parse({"--help"})->help);
  CHECK(parse({"--version"})->version);
}
