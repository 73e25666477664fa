#include "server/fairwayd/http/http_head.h"

#include <string>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

std::string post(const std::string& headers) {
  return "POST /v1/jobs HTTP/1.1\r\nHost: t\r\n" + headers + "\r\n";
}

bool is_refused(const std::string& head) {
  const auto parsed = parse_request_head(head);
  return !parsed && parsed.error().code == ErrorCode::bad_request;
}

}  // namespace

TEST_CASE("headers are kept with their names in lower case, in their order") {
  const auto head = parse_request_head(post("RANGE:  bytes=0-9 \r\nX-Twice: a\r\nx-twice: b\r\n"));
  REQUIRE(head);
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"host", "t"}, {"range", "bytes=0-9"}, {"x-twice", "a"}, {"x-twice", "b"}};
  CHECK(head->headers == expected);
  CHECK(head->text.find("RANGE") == std::string::npos);
}

TEST_CASE("a head says how its body ends") {
  const auto length = parse_request_head(post("content-length: 12\r\n"));
  REQUIRE(length);
  CHECK(length->framing.length == 12);
  CHECK(length->framing.has_body());
  const auto chunked = parse_request_head(post("Transfer-Encoding: CHUNKED\r\n"));
  REQUIRE(chunked);
  CHECK(chunked->framing.chunked);
  const auto none = parse_request_head(post(""));
  REQUIRE(none);
  CHECK_FALSE(none->framing.has_body());
}

TEST_CASE("a length beyond 64 bits stays a length") {
  const auto head = parse_request_head(post("Content-Length: 99999999999999999999999\r\n"));
  REQUIRE(head);
  CHECK(head->framing.length == UINT64_MAX);
}

TEST_CASE("ambiguous framing is refused") {
  for (const char* headers :
       {"Content-Length: 1\r\nContent-Length: 1\r\n", "Content-Length: -1\r\n",
        "Content-Length: +1\r\n", "Content-Length: 1x\r\n", "Content-Length: \r\n",
        "Content-Length: 0x1\r\n", "Content-Length: 1, 1\r\n",
        "Content-Length: 1\r\nTransfer-Encoding: chunked\r\n", "Transfer-Encoding: gzip\r\n",
        "Transfer-Encoding: gzip, chunked\r\n",
        "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n", "Transfer-Encoding:\r\n"}) {
    CAPTURE(headers);
    CHECK(is_refused(post(headers)));
  }
}

TEST_CASE("broken lines are refused") {
  for (const char* headers : {"Name : x\r\n", ": x\r\n", "no colon\r\n", " folded: x\r\n",
                              "A: x\rB: y\r\n", "A: \x01\r\n", "Expect: 200-ok\r\n"}) {
    CAPTURE(headers);
    CHECK(is_refused(post(headers)));
  }
  for (const char* line : {"", "GET", "GET /", "GET  HTTP/1.1", "GET x HTTP/1.1", "GET / HTTP/2",
                           "GET /a b HTTP/1.1", "G=T / HTTP/1.1", "GET / HTTP/1.1 "}) {
    CAPTURE(line);
    CHECK(is_refused(std::string(line) + "\r\n\r\n"));
  }
}

TEST_CASE("every truncation of a head is refused") {
  const std::string whole = post("Content-Length: 1\r\n");
  REQUIRE(parse_request_head(whole));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CAPTURE(size);
    CHECK(is_refused(whole.substr(0, size)));
  }
}

TEST_CASE("the size of a head is bounded, and what is too long is told") {
  const auto refusal_of = [](const std::string& head) {
    const auto parsed = parse_request_head(head);
    REQUIRE_FALSE(parsed);
    return parsed.error().code;
  };
  CHECK(refusal_of("GET /" + std::string(kMaxHeadLine, 'x') + " HTTP/1.1\r\n\r\n") ==
        ErrorCode::uri_too_long);
  CHECK(refusal_of(post("A: " + std::string(kMaxHeadLine, 'x') + "\r\n")) ==
        ErrorCode::headers_too_large);
  std::string many;
  for (std::size_t i = 0; i < kMaxHeaders; ++i) many += "A: x\r\n";
  CHECK(refusal_of(post(many)) == ErrorCode::headers_too_large);
}

TEST_CASE("what is dealt with before the library does not reach it") {
  const auto head = parse_request_head(
      post("Content-Length: 1\r\nRange: bytes=0-1\r\nAccept-Encoding: gzip\r\nAccept: x\r\n"
           "Expect: 100-continue\r\nContent-Encoding: gzip\r\nConnection: close\r\n"));
  REQUIRE(head);
  CHECK(head->text == "POST /v1/jobs HTTP/1.1\r\nHost: t\r\nAccept: x\r\n\r\n");
  CHECK(head->expects_continue);
  CHECK(head->has_content_encoding);
  CHECK_FALSE(head->keep_alive);
}

TEST_CASE("connections persist by version unless told otherwise") {
  CHECK(parse_request_head("GET / HTTP/1.1\r\n\r\n")->keep_alive);
  CHECK_FALSE(parse_request_head("GET / HTTP/1.0\r\n\r\n")->keep_alive);
}
