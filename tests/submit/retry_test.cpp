// What is tried again, and after which pause.
#include "server/fairway-submit/retry.h"

#include <chrono>
#include <ctime>

#include <catch2/catch.hpp>

#include "server/fairway-submit/problem_answer.h"
#include "server/fairway-submit/repr_digest.h"

using namespace fairway;
using std::chrono::milliseconds;

namespace {

HttpAnswer answer_of(int status, const std::string& retry_after = "") {
  HttpAnswer answer{.status = status};
  if (!retry_after.empty()) answer.headers["retry-after"] = retry_after;
  return answer;
}

std::string date_in(std::time_t seconds) {
  const std::time_t then = std::time(nullptr) + seconds;
  std::tm parts{};
  ::gmtime_r(&then, &parts);
  std::array<char, 64> text{};
  std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT", &parts);
  return text.data();
}

}  // namespace

TEST_CASE("only what may become another answer is tried again") {
  for (const int status : {408, 409, 429, 507}) {
    CHECK(worth_of(answer_of(status)) == Worth::later);
  }
  for (const int status : {502, 503, 504}) {
    CHECK(worth_of(answer_of(status)) == Worth::unreachable);
  }
  for (const int status : {200, 202, 304, 301, 400, 401, 403, 404, 410, 413, 415, 422, 500}) {
    CHECK(worth_of(answer_of(status)) == Worth::settled);
  }
  CHECK(worth_of({.lost = HttpAnswer::Lost::connection}) == Worth::unreachable);
  CHECK(worth_of({.lost = HttpAnswer::Lost::distrust}) == Worth::settled);
  CHECK(worth_of({.lost = HttpAnswer::Lost::by_receiver}) == Worth::settled);
}

TEST_CASE("Retry-After is read as seconds and as a date") {
  CHECK(retry_after(answer_of(429, "7")) == milliseconds(7000));
  CHECK(retry_after(answer_of(429, "0")) == milliseconds(0));
  const auto dated = retry_after(answer_of(503, date_in(100)));
  REQUIRE(dated);
  CHECK(*dated > milliseconds(60'000));
  CHECK(*dated <= milliseconds(100'000));
  CHECK(retry_after(answer_of(503, date_in(-100))) == milliseconds(0));
  for (const char* nothing : {"", "soon", "-1", "1.5", "99999999999999999999"}) {
    CHECK_FALSE(retry_after(answer_of(429, nothing)));
  }
}

TEST_CASE("pauses grow to ten seconds, differ between clients, and are never shorter than asked") {
  Backoff one(1);
  Backoff other(2);
  bool differs = false;
  milliseconds full(100);
  for (int i = 0; i < 20; ++i) {
    const milliseconds pause = one.next(answer_of(0));
    CHECK(pause <= full);
    CHECK(pause >= full / 2);
    differs = differs || pause != other.next(answer_of(0));
    full = std::min(full * 2, milliseconds(10'000));
  }
  CHECK(differs);
  CHECK(one.next(answer_of(429, "30")) >= milliseconds(30'000));
}

TEST_CASE("a problem is made of every answer that states none") {
  HttpAnswer stated{.status = 422};
  stated.body = R"({"title":"Invalid mesh","code":"invalid_mesh","detail":"It is."})";
  CHECK(problem_of(stated)["code"] == "invalid_mesh");
  HttpAnswer moved{.status = 301};
  moved.headers["location"] = "http://elsewhere/";
  CHECK(problem_of(moved)["detail"].get<std::string>().find("http://elsewhere/") !=
        std::string::npos);
  HttpAnswer page{.status = 418};
  page.body = "<html>";
  CHECK(problem_of(page)["detail"].get<std::string>().find("418") != std::string::npos);
  const HttpAnswer none{.lost = HttpAnswer::Lost::connection, .reason = "no connection"};
  CHECK(problem_of(none)["code"] == "unavailable");
}

TEST_CASE("a digest field is read, or nothing is") {
  // RFC 9530, B.1: of {"hello": "world"} and a line end.
  CHECK(sha256_of_repr_digest("sha-256=:RK/0qy18MlBSVnWgjwz6lZEWjP/lF5HF9bvEF8FabDg=:") ==
        "44aff4ab2d7c3250525675a08f0cfa9591168cffe51791c5f5bbc417c15a6c38");
  CHECK(
      sha256_of_repr_digest("sha-512=:AAAA:, sha-256=:RK/0qy18MlBSVnWgjwz6lZEWjP/lF5HF9bvEF8FabDg"
                            "=:"));
  CHECK_FALSE(sha256_of_repr_digest(""));
  CHECK_FALSE(sha256_of_repr_digest("sha-256=:RK/0:"));
  CHECK_FALSE(sha256_of_repr_digest("sha-256=:!K/0qy18MlBSVnWgjwz6lZEWjP/lF5HF9bvEF8FabDg=:"));
}
