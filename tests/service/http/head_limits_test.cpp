// What is refused before a body is sent.
#include <string>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <fmt/format.h>

#include "server/fairwayd/http/http_head.h"
#include "server/fairwayd/http/http_server.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

std::string expecting(const std::string& target, std::size_t length) {
  return fmt::format(
      "POST {} HTTP/1.1\r\nHost: t\r\nContent-Type: model/gltf-binary\r\n"
      "Content-Length: {}\r\nExpect: 100-continue\r\n\r\n",
      target, length);
}

class Alive final : public HttpApplication {
 public:
  bool wants_body(const HttpRequest&) const override { return true; }
  HttpResponse answer(const HttpRequest&, BodySource& body) override {
    const auto read = body.read([](std::span<const std::byte>) { return Result<void>(); });
    return read ? json_response(Json{{"status", "alive"}}) : problem_response(read.error());
  }
};

}  // namespace

TEST_CASE("a head beyond its limits is told which one") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const auto send = [&](const std::string& head) {
    RawConnection connection(service.port());
    connection.send(head);
    std::string answer = connection.read_all();
    CHECK(answer.find("Connection: close\r\n") != std::string::npos);
    return answer;
  };
  const std::string line = "GET /livez HTTP/1.1\r\n";
  const std::string address = send("GET /" + std::string(9000, 'x') + " HTTP/1.1\r\n\r\n");
  CHECK(address.starts_with("HTTP/1.1 414 "));
  CHECK(address.find("\"code\":\"uri_too_long\"") != std::string::npos);
  const std::string header = send(line + "A: " + std::string(9000, 'x') + "\r\n\r\n");
  CHECK(header.starts_with("HTTP/1.1 431 "));
  CHECK(header.find("\"code\":\"headers_too_large\"") != std::string::npos);
  std::string many = line;
  for (std::size_t i = 0; i <= kMaxHeaders; ++i) many += "A: x\r\n";
  CHECK(send(many + "\r\n").starts_with("HTTP/1.1 431 "));
}

TEST_CASE("a request that comes too slowly is told so") {
  const UniqueFd null(::open("/dev/null", O_WRONLY | O_CLOEXEC));
  const Log log(null.get());
  auto stopping = EventFlag::create();
  auto listener = listen_on({"127.0.0.1", 0});
  REQUIRE((stopping && listener));
  const std::uint16_t port = listener->address.port;
  ConnectionLimits limits;
  limits.head = limits.stall = std::chrono::milliseconds(50);
  limits.body_bytes = 100;
  Alive application;
  HttpServer server(std::move(*listener), application, log, limits, *stopping);
  server.start();
  for (const char* sent :
       {"GET / HT", "POST / HTTP/1.1\r\nHost: t\r\nContent-Length: 9\r\n\r\nabc"}) {
    RawConnection connection(port);
    connection.send(sent);
    const std::string answer = connection.read_all();
    CAPTURE(sent, answer);
    CHECK(answer.starts_with("HTTP/1.1 408 "));
    CHECK(answer.find("Connection: close\r\n") != std::string::npos);
    CHECK(answer.find("\"code\":\"request_timeout\"") != std::string::npos);
  }
  stopping->raise();
}

TEST_CASE("an upload is refused before it is sent, to a client that asks first") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(),
                               {"--max-body", "100000", "--workers", "1", "--queue", "1"});
  const auto ask = [&](const std::string& target, std::size_t length) {
    RawConnection connection(service.port());
    connection.send(expecting(target, length));
    const std::string answer = connection.read_all();
    CHECK(answer.find("100 Continue") == std::string::npos);
    return answer.substr(0, 13);
  };
  for (const std::string path : {"/v1/jobs", "/v1/denoise", "/v1/inspect"}) {
    CAPTURE(path);
    CHECK(ask(path, 100001) == "HTTP/1.1 413 ");
    CHECK(ask(path + "?params=%7B%22stepz%22:1%7D", 10) == "HTTP/1.1 422 ");
    CHECK(ask(path + "?what=1", 10) == "HTTP/1.1 400 ");
  }
  const std::string mesh = small_glb();
  RawConnection connection(service.port());
  connection.send(expecting("/v1/jobs", mesh.size()));
  CHECK(connection.read_until("\r\n\r\n") == "HTTP/1.1 100 Continue\r\n\r\n");
  connection.send(mesh);
  CHECK(connection.read_until("\r\n\r\n").starts_with("HTTP/1.1 202 "));
}
