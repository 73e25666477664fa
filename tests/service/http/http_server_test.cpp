// Who is served where there are more clients than places.
#include "server/fairwayd/http/http_server.h"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <catch2/catch.hpp>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>

using namespace fairway;
using namespace std::chrono_literals;

namespace {

/// Answers at once, but for /wait, which it holds until release().
class Application final : public HttpApplication {
 public:
  bool wants_body(const HttpRequest& request) const override { return request.method == "POST"; }
  bool is_vital(std::string_view, std::string_view path) const override { return path == "/vital"; }
  HttpResponse answer(const HttpRequest& request, BodySource& body) override {
    ++answered_;
    if (request.path == "/wait") {
      std::unique_lock lock(mutex_);
      ++held_;
      changed_.notify_all();
      changed_.wait(lock, [this] { return released_; });
    }
    const auto read = body.read([](std::span<const std::byte>) { return Result<void>(); });
    return read ? json_response(Json{{"path", request.path}}) : problem_response(read.error());
  }
  void wait_until_held(int count) {
    std::unique_lock lock(mutex_);
    REQUIRE(changed_.wait_for(lock, 60s, [&] { return held_ == count; }));
  }
  void release() {
    const std::lock_guard lock(mutex_);
    released_ = true;
    changed_.notify_all();
  }

 private:
  std::atomic<int> answered_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  int held_ = 0;
  bool released_ = false;
};

class Client {
 public:
  Client(std::uint16_t port, const char* from) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    ::inet_pton(AF_INET, from, &own.sin_addr);
    REQUIRE(::bind(socket_.get(), reinterpret_cast<sockaddr*>(&own), sizeof own) == 0);
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_port = htons(port);
    server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(::connect(socket_.get(), reinterpret_cast<sockaddr*>(&server), sizeof server) == 0);
    const timeval patience{60, 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  void send(const std::string& bytes) {
    ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  /// All until the server closes.
  std::string read_all() {
    std::string text;
    std::array<char, 1000> chunk;
    for (ssize_t got; (got = ::recv(socket_.get(), chunk.data(), chunk.size(), 0)) > 0;) {
      text.append(chunk.data(), static_cast<std::size_t>(got));
    }
    return text;
  }
  std::string get(const std::string& path) {
    send("GET " + path + " HTTP/1.1\r\nHost: t\r\nConnection: close\r\n\r\n");
    return read_all().substr(0, 12);
  }

 private:
  UniqueFd socket_;
};

/// A server with few places and much patience: nobody goes because of time.
class Fixture {
 public:
  explicit Fixture(const ServerCapacity& capacity) {
    auto flag = EventFlag::create();
    auto listener = listen_on({"127.0.0.1", 0});
    REQUIRE((flag && listener));
    stopping_ = std::make_unique<EventFlag>(std::move(*flag));
    port_ = listener->address.port;
    ConnectionLimits limits;
    limits.idle = limits.head = limits.stall = 600s;
    limits.least_rate = 1;
    limits.body_bytes = 1 << 20;
    server_ = std::make_unique<HttpServer>(std::move(*listener), application, log_, limits,
                                           *stopping_, capacity);
    server_->start();
  }
  ~Fixture() {
    application.release();
    stopping_->raise();
  }

  Client client(const char* from = "127.0.0.1") const { return {port_, from}; }
  /// Clients that send this and are silent then, for longer than it takes to be slow.
  std::vector<Client> silent(int count, const std::string& sent, const char* from = "127.0.0.1") {
    std::vector<Client> all;
    for (int i = 0; i < count; ++i) {
      all.push_back(client(from));
      all.back().send(sent);
      std::this_thread::sleep_for(50ms);  // so that the first one is the slowest
    }
    std::this_thread::sleep_for(1500ms);
    return all;
  }

  Application application;

 private:
  const UniqueFd null_{::open("/dev/null", O_WRONLY | O_CLOEXEC)};
  const Log log_{null_.get()};
  std::unique_ptr<EventFlag> stopping_;
  std::uint16_t port_ = 0;
  std::unique_ptr<HttpServer> server_;
};

const std::string kPartOfHead = "GET / HTTP/1.1\r\nHost: ";
const std::string kPartOfBody = "POST / HTTP/1.1\r\nHost: t\r\nContent-Length: 1000\r\n\r\nabc";

}  // namespace

TEST_CASE("a newcomer takes the place of an idle client, of one in its head, of one in its body") {
  for (const std::string& sent : {std::string(), kPartOfHead, kPartOfBody}) {
    CAPTURE(sent);
    Fixture f({.connections = 3, .vital = 1});
    auto crowd = f.silent(3, sent);
    for (int i = 0; i < 3; ++i) CHECK(f.client().get("/") == "HTTP/1.1 200");
    // The slowest is told why, where it had begun to ask.
    const std::string told = crowd.front().read_all();
    CHECK(told.substr(0, 12) == (sent.empty() ? "" : "HTTP/1.1 503"));
    if (!sent.empty()) CHECK(told.find("Retry-After: 2\r\n") != std::string::npos);
  }
}

TEST_CASE("where nobody is slow only what is vital is answered") {
  Fixture f({.connections = 2, .vital = 1});
  std::vector<Client> busy;
  for (int i = 0; i < 2; ++i) {
    busy.push_back(f.client());
    busy.back().send("GET /wait HTTP/1.1\r\nHost: t\r\nConnection: close\r\n\r\n");
  }
  f.application.wait_until_held(2);
  for (int i = 0; i < 3; ++i) {
    CHECK(f.client().get("/vital") == "HTTP/1.1 200");
    CHECK(f.client().get("/other") == "HTTP/1.1 503");
  }
  // Who says nothing does not hold the place for what is vital.
  auto silent = f.client();
  CHECK(f.client().get("/vital") == "HTTP/1.1 200");
  f.application.release();
  for (Client& client : busy) CHECK(client.read_all().substr(0, 12) == "HTTP/1.1 200");
}

TEST_CASE(
    "in a full house clients that are silent, drip or send much keep nobody from what is vital") {
  Fixture f({.connections = 1, .vital = 1});
  Client busy = f.client();
  busy.send("GET /wait HTTP/1.1\r\nHost: t\r\nConnection: close\r\n\r\n");
  f.application.wait_until_held(1);
  const std::string cut_short = "GET /vital HTTP/1.1\r\nHost: ";
  std::vector<Client> crowd;
  crowd.reserve(300);
  for (int i = 0; i < 100; ++i) {
    crowd.push_back(f.client());
    crowd.push_back(f.client());
    crowd.back().send(cut_short);
    crowd.push_back(f.client());
    crowd.back().send(kPartOfBody + std::string(100000, 'x'));
    const auto began = std::chrono::steady_clock::now();
    CHECK(f.client().get("/vital") == "HTTP/1.1 200");
    CHECK(std::chrono::steady_clock::now() - began < 900ms);  // the patience with the others
  }
  // Each of them is told in the end.
  for (Client& client : crowd) CHECK(client.read_all().substr(0, 12) == "HTTP/1.1 503");
}

TEST_CASE("a newcomer of an address with many places never takes that of one with few") {
  Fixture f({.connections = 4, .vital = 1});
  auto honest = f.client("127.0.0.3");
  honest.send(kPartOfBody);
  auto greedy = f.silent(3, kPartOfBody, "127.0.0.2");
  // The greedy one's own newcomers displace its own.
  for (int i = 0; i < 8; ++i) {
    greedy.push_back(f.client("127.0.0.2"));
    greedy.back().send(kPartOfBody);
    std::this_thread::sleep_for(1100ms);
  }
  honest.send(std::string(997, 'x') + "GET / HTTP/1.1\r\nHost: t\r\nConnection: close\r\n\r\n");
  const std::string answers = honest.read_all();
  CHECK(answers.substr(0, 12) == "HTTP/1.1 200");
}

TEST_CASE("an address that is fast in most places gives one of them to another address") {
  Fixture f({.connections = 3, .vital = 1});
  std::vector<Client> greedy;
  for (int i = 0; i < 3; ++i) {
    greedy.push_back(f.client("127.0.0.2"));
    greedy.back().send(kPartOfBody);
  }
  std::jthread drip([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      for (Client& client : greedy) client.send("x");
      std::this_thread::sleep_for(50ms);
    }
  });
  std::this_thread::sleep_for(500ms);
  CHECK(f.client("127.0.0.2").get("/") == "HTTP/1.1 503");
  CHECK(f.client("127.0.0.3").get("/") == "HTTP/1.1 200");
}
