#include "server/fairwayd/http/http_accept.h"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

int weight(const std::vector<std::string>& values, std::string_view type = "model/ply") {
  HttpRequest request;
  for (const std::string& value : values) request.headers.emplace_back("accept", value);
  return accept_weight(request, type);
}

}  // namespace

TEST_CASE("a type is accepted by its name, by its kind, by any, and without a word") {
  CHECK(weight({}) == kFullWeight);
  CHECK(weight({""}) == kFullWeight);
  CHECK(weight({"*/*"}) == kFullWeight);
  CHECK(weight({"model/*"}) == kFullWeight);
  CHECK(weight({"Model/PLY"}) == kFullWeight);
  CHECK(weight({"text/html, model/ply;q=0.5"}) == 500);
  CHECK(weight({"text/html", "model/ply"}) == kFullWeight);
}

TEST_CASE("a type that no range names is excluded") {
  CHECK(weight({"model/stl"}) == 0);
  CHECK(weight({"text/*, application/json"}) == 0);
  CHECK(weight({"model/plyx"}) == 0);
  CHECK(weight({"mod/*"}) == 0);
  CHECK(weight({"model/ply;version=2"}) == 0);
}

TEST_CASE("the most specific range decides, wherever it stands") {
  CHECK(weight({"model/ply;q=0, */*"}) == 0);
  CHECK(weight({"*/*, model/*;q=0.3"}) == 300);
  CHECK(weight({"model/*;q=0", "model/ply;q=0.001"}) == 1);
  CHECK(weight({"*/*;q=0"}) == 0);
}

TEST_CASE("weights have up to three digits, and nonsense is a full weight") {
  CHECK(weight({"model/ply; q=0"}) == 0);
  CHECK(weight({"model/ply;q=0.000"}) == 0);
  CHECK(weight({"model/ply;Q=0."}) == 0);
  CHECK(weight({"model/ply;q=0.25"}) == 250);
  CHECK(weight({"model/ply;q=1.000"}) == kFullWeight);
  for (const char* q : {"", "x", "-1", "0.1234", "0.x", "2"}) {
    CAPTURE(q);
    CHECK(weight({std::string("model/ply;q=") + q}) == kFullWeight);
  }
}

TEST_CASE("a coding is taken where it is named or all are, and not refused") {
  const auto takes = [](const char* value) {
    HttpRequest request;
    request.headers.emplace_back("accept-encoding", value);
    return takes_coding(request, "gzip");
  };
  CHECK(takes("gzip"));
  CHECK(takes("deflate, GZIP;q=0.5, br"));
  CHECK(takes("*"));
  CHECK_FALSE(takes("br"));
  CHECK_FALSE(takes(""));
  CHECK_FALSE(takes("gzip;q=0"));
  CHECK_FALSE(takes("gzip;q=0, *"));
  CHECK_FALSE(takes("*;q=0"));
  CHECK_FALSE(takes_coding(HttpRequest(), "gzip"));
}
