#include "server/os/file.h"

#include <set>
#include <string_view>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <sys/socket.h>

#include "server/os/child_process.h"
#include "server/os/line_reader.h"
#include "server/os/random_id.h"
#include "tests/service/temporary_directory.h"

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
