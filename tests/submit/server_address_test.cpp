#include "server/fairway-submit/server_address.h"

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

std::string canonical(const char* url) {
  const auto address = parse_server_address(url);
  return address ? to_string(*address) : "refused";
}

}  // namespace

TEST_CASE("the URL of a server is read with or without port and prefix") {
  CHECK(canonical("http://127.0.0.1:8080") == "http://127.0.0.1:8080");
  CHECK(canonical("HTTP://Host/") == "http://host:80");
  CHECK(canonical("https://host") == "https://host:443");
  CHECK(canonical("https://host/mesh/api/") == "https://host:443/mesh/api");
  CHECK(canonical("http://[::1]:81/x") == "http://[::1]:81/x");
  CHECK(canonical("http://[::1]") == "http://[::1]:80");
}

TEST_CASE("what is no URL of a server is refused") {
  for (const char* url :
       {"", "host:80", "ftp://host", "http://", "http://:80", "http://host:", "http://host:0",
        "http://host:65536", "http://host:8x", "http://user@host", "http://host/?q", "http://[::1",
        "http://[::1]80", "http://ho st", "http://host/#f"}) {
    CAPTURE(url);
    CHECK(canonical(url) == "refused");
  }
}
