// What the client sends, as a listener sees it that never answers.
#include <string>

#include <arpa/inet.h>
#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include "server/fairway-submit/file_task.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/submit/submit_fixture.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// Takes connections, reads the head of a request, and hangs up: every answer is lost.
class Listener {
 public:
  Listener() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    REQUIRE(::bind(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(::listen(socket_.get(), 8) == 0);
    socklen_t size = sizeof address;
    ::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }

  std::uint16_t port() const { return port_; }

  std::string next_head() const {
    pollfd entry{socket_.get(), POLLIN, 0};
    constexpr int kPatienceMillis = 60'000;
    REQUIRE(::poll(&entry, 1, kPatienceMillis) > 0);
    const UniqueFd connection(::accept(socket_.get(), nullptr, nullptr));
    std::string head;
    for (char c = 0; !head.ends_with("\r\n\r\n") && ::recv(connection.get(), &c, 1, 0) == 1;) {
      head += c;
    }
    return head;
  }

 private:
  UniqueFd socket_;
  std::uint16_t port_ = 0;
};

/// The value of a field in a head; "" where there is none.
std::string field(const std::string& head, const std::string& name) {
  const std::size_t at = head.find("\r\n" + name + ": ");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + name.size() + 4;
  return head.substr(begin, head.find("\r\n", begin) - begin);
}

std::string key_of(const Listener& listener) {
  const std::string head = listener.next_head();
  CAPTURE(head);
  CHECK(head.starts_with("POST /v1/jobs?params="));
  std::string key = field(head, "Idempotency-Key");
  CHECK(key.size() > 30);
  return key;
}

}  // namespace

TEST_CASE("tries after a lost answer have one key, also those of a later run") {
  const SubmitPlace place;
  const Listener listener;
  const auto files = place.write_meshes(2);
  std::string key;
  {
    const SubmitProcess client(place.arguments(listener.port(), {files[0]}));
    key = key_of(listener);
    CHECK(key_of(listener) == key);
  }
  const auto first_key = [&](const std::string& file, const std::vector<std::string>& more = {}) {
    const SubmitProcess client(place.arguments(listener.port(), {file}, more));
    return key_of(listener);
  };
  CHECK(first_key(files[0]) == key);
  CHECK(first_key(files[1]) != key);
  CHECK(first_key(files[0], {"--params", R"({"steps":1})"}) != key);
  CHECK(first_key(files[0], {"--label", "batch:1"}) != key);
  place.write("m000.glb", noisy_torus(6));
  CHECK(first_key(files[0]) != key);
  const SubmitPlace other;
  const SubmitProcess client(other.arguments(listener.port(), {files[0]}));
  CHECK(key_of(listener) != key);
}

TEST_CASE("another attempt has another key") {
  JournalEntry entry{.payload = "p"};
  const std::string first = idempotency_key("batch", "a.glb", entry, {});
  CHECK(idempotency_key("batch", "a.glb", entry, {}) == first);
  entry.attempt = 2;
  CHECK(idempotency_key("batch", "a.glb", entry, {}) != first);
}

TEST_CASE("an API key comes from the environment, and is blotted out of the command line") {
  const SubmitPlace place;
  const Listener listener;
  const auto files = place.write_meshes(1);
  {
    const SubmitProcess client(place.arguments(listener.port(), files), {"FAIRWAY_API_KEY=s3cret"});
    CHECK(field(listener.next_head(), "Authorization") == "Bearer s3cret");
  }
  const std::string file = place.write("key", "from-file\n");
  {
    const SubmitProcess client(place.arguments(listener.port(), files, {"--api-key", "@" + file}));
    CHECK(field(listener.next_head(), "Authorization") == "Bearer from-file");
  }
  const SubmitProcess client(place.arguments(listener.port(), files, {"--api-key", "s3cret"}));
  CHECK(field(listener.next_head(), "Authorization") == "Bearer s3cret");
  const std::string line = read_file(fmt::format("/proc/{}/cmdline", client.pid()));
  CHECK(line.find("--api-key") != std::string::npos);
  CHECK(line.find("s3cret") == std::string::npos);
}

TEST_CASE("labels are sent as they are asked for") {
  const SubmitPlace place;
  const Listener listener;
  const SubmitProcess client(place.arguments(listener.port(), place.write_meshes(1),
                                             {"--label", "batch:7", "--label", "who:a b"}));
  const std::string head = listener.next_head();
  CAPTURE(head);
  CHECK(head.find("&label=batch%3A7&label=who%3Aa%20b HTTP/1.1\r\n") != std::string::npos);
}
