#include "server/os/file.h"

#include <algorithm>
#include <array>
#include <climits>
#include <set>
#include <string_view>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/os/child_process.h"
#include "server/os/line_reader.h"
#include "server/os/random_id.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;

TEST_CASE("an atomic file has no name before its commit and no temporary one after") {
  test::TemporaryDirectory directory;
  const auto temporary = directory.path() / "tmp";
  const auto final_path = directory.path() / "final";
  {
    auto dropped = AtomicFile::create(temporary);
    REQUIRE(dropped);
    CHECK(std::filesystem::exists(temporary));
  }
  CHECK_FALSE(std::filesystem::exists(temporary));
  auto kept = AtomicFile::create(temporary);
  REQUIRE(kept);
  CHECK_FALSE(std::filesystem::exists(final_path));
  REQUIRE(kept->commit(final_path));
  CHECK(std::filesystem::exists(final_path));
  CHECK_FALSE(std::filesystem::exists(temporary));
}

TEST_CASE("an atomic file may be named relative to the working directory") {
  test::TemporaryDirectory directory;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(directory.path());
  auto file = AtomicFile::create("tmp");
  const bool committed = file && file->commit("final");
  std::filesystem::current_path(before);
  CHECK(committed);
  CHECK(std::filesystem::exists(directory.path() / "final"));
}

TEST_CASE("a full disk is told from a broken file") {
  const auto full = open_file("/dev/full", O_WRONLY);
  REQUIRE(full);
  const std::byte byte{1};
  const auto written = write_all(full->get(), {&byte, 1});
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::storage_full);
  const auto absent = open_file("/nonexistent/file", O_RDONLY);
  REQUIRE_FALSE(absent);
  CHECK(absent.error().code == ErrorCode::io);
}

TEST_CASE("pieces arrive in order however many there are and however little is taken at once") {
  std::array<int, 2> ends{};
  REQUIRE(pipe2(ends.data(), O_CLOEXEC) == 0);
  const UniqueFd from(ends[0]);
  UniqueFd to(ends[1]);
  fcntl(to.get(), F_SETPIPE_SZ, 4096);
  std::vector<std::byte> whole(100'000);
  for (std::size_t i = 0; i < whole.size(); ++i) whole[i] = static_cast<std::byte>(i * i >> 7U);
  std::vector<std::span<const std::byte>> pieces;
  for (std::size_t at = 0, size = 1; at < whole.size(); at += size, size = 1 + at % 83) {
    pieces.push_back(std::span(whole).subspan(at, std::min(size, whole.size() - at)));
  }
  pieces.push_back(std::span(whole).first(50'000));
  REQUIRE(pieces.size() > IOV_MAX);
  // A signal makes the system stop in the middle of a write.
  struct sigaction interrupt = {};
  interrupt.sa_handler = [](int /*signal*/) {};
  struct sigaction before = {};
  REQUIRE(sigaction(SIGUSR1, &interrupt, &before) == 0);
  std::vector<std::byte> got;
  std::thread reader([&, writer = pthread_self()] {
    std::array<std::byte, 777> buffer{};
    for (ssize_t n = 0; (n = ::read(from.get(), buffer.data(), buffer.size())) > 0;) {
      got.insert(got.end(), buffer.begin(), buffer.begin() + n);
      pthread_kill(writer, SIGUSR1);
    }
  });
  const auto written = write_all(to.get(), pieces);
  to = UniqueFd();
  reader.join();
  sigaction(SIGUSR1, &before, nullptr);
  REQUIRE(written);
  whole.insert(whole.end(), whole.begin(), whole.begin() + 50'000);
  CHECK(got == whole);
}

TEST_CASE("random ids are URL-safe, of one shape, and differ") {
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) {
    const std::string id = random_id();
    REQUIRE(is_random_id(id));
    seen.insert(id);
  }
  CHECK(seen.size() == 1000);
  CHECK_FALSE(is_random_id(""));
  CHECK_FALSE(is_random_id("../../../../etc/passwd"));
  CHECK_FALSE(is_random_id(std::string(23, 'a')));
}

TEST_CASE("lines arrive whole, however they were cut, and an endless one is refused") {
  auto ends = socket_pair();
  REQUIRE(ends);
  LineReader reader(ends->second.get(), 8);
  const auto send = [&](std::string_view text) {
    REQUIRE(::send(ends->first.get(), text.data(), text.size(), 0) ==
            static_cast<ssize_t>(text.size()));
  };
  send("ab");
  CHECK(reader.fill() == LineReader::Status::data);
  CHECK_FALSE(reader.next());
  send("c\n\nde");
  CHECK(reader.fill() == LineReader::Status::data);
  CHECK(reader.next() == "abc");
  CHECK(reader.next() == "");
  CHECK_FALSE(reader.next());
  send("fgh\n");
  CHECK(reader.fill() == LineReader::Status::data);
  CHECK(reader.next() == "defgh");
  send("123456789");
  CHECK(reader.fill() == LineReader::Status::too_long);
  ends->first.reset();
  CHECK(reader.fill() == LineReader::Status::end);
}
