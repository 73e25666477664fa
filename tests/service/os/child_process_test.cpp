#include "server/os/child_process.h"

#include <csignal>
#include <optional>
#include <string>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "server/os/file.h"

using namespace fairway;

namespace {

/// Runs a shell command; its standard output comes back where `output` is given.
Result<ChildProcess> shell(const std::string& command, int output) {
  return ChildProcess::spawn({"/bin/sh", {"-c", command}, {}, {output, output, output}});
}

UniqueFd null_device() {
  auto fd = open_file("/dev/null", O_RDWR);
  REQUIRE(fd);
  return std::move(*fd);
}

}  // namespace

TEST_CASE("a child's exit code and signal come back") {
  const UniqueFd null = null_device();
  auto coded = shell("exit 7", null.get());
  REQUIRE(coded);
  CHECK(coded->wait().code == 7);
  CHECK(coded->wait().code == 7);
  auto killed = shell("exec sleep 60", null.get());
  REQUIRE(killed);
  killed->kill(SIGKILL);
  CHECK(killed->wait().signal == SIGKILL);
}

TEST_CASE("a child inherits its three descriptors and nothing else") {
  auto ends = socket_pair();
  REQUIRE(ends);
  const UniqueFd leaky(::open("/dev/null", O_RDONLY));  // without close-on-exec
  auto child = shell("ls /proc/self/fd | wc -l; env | grep -vc '^PWD\\|^SHLVL\\|^_\\|^OLDPWD'",
                     ends->second.get());
  REQUIRE(child);
  ends->second.reset();
  std::string text;
  char chunk[100];
  for (ssize_t got; (got = ::read(ends->first.get(), chunk, sizeof chunk)) > 0;) {
    text.append(chunk, static_cast<std::size_t>(got));
  }
  child->wait();
  // 0, 1, 2 and the directory that ls itself has open; no variable.
  CHECK(text == "4\n0\n");
}

TEST_CASE("a child does not outlive its owner") {
  const UniqueFd null = null_device();
  std::optional<pid_t> pid;
  {
    auto child = shell("exec sleep 60", null.get());
    REQUIRE(child);
    pid = child->pid();
    CHECK(::kill(*pid, 0) == 0);
  }
  CHECK(::kill(*pid, 0) != 0);
}

TEST_CASE("the process descriptor tells the end to poll") {
  const UniqueFd null = null_device();
  auto child = shell("exec sleep 60", null.get());
  REQUIRE(child);
  pollfd entry{child->descriptor(), POLLIN, 0};
  CHECK(::poll(&entry, 1, 0) == 0);
  child->kill(SIGTERM);
  CHECK(::poll(&entry, 1, 5000) == 1);
}

TEST_CASE("a program that is not there is an error, not a child") {
  const UniqueFd null = null_device();
  const auto child =
      ChildProcess::spawn({"/nonexistent/program", {}, {}, {null.get(), null.get(), null.get()}});
  REQUIRE_FALSE(child);
  CHECK(child.error().code == ErrorCode::io);
}

TEST_CASE("the largest memory of a child and of its own children comes back") {
  const UniqueFd null = null_device();
  auto small = shell("exit 0", null.get());
  auto large = shell("head -c 60000000 /dev/zero | tail -c 60000000", null.get());
  REQUIRE((small && large));
  const std::uint64_t base = small->wait().peak_resident_bytes;
  CHECK(base > 100'000);
  CHECK(large->wait().peak_resident_bytes > 50'000'000);
  CHECK(large->wait().peak_resident_bytes > base);
}
