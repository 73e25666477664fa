// What the journal promises to whoever comes after a crash.
#include "server/fairway-submit/journal.h"

#include <fstream>

#include <catch2/catch.hpp>

#include "tests/service/support/temporary_directory.h"
#include "tests/submit/submit_fixture.h"

using namespace fairway;
using namespace fairway::test;

namespace {

struct Folder {
  Journal open() const {
    auto journal = Journal::open(path);
    REQUIRE(journal);
    return *std::move(journal);
  }
  void append(const std::string& text) const {
    std::ofstream(path, std::ios::binary | std::ios::app) << text;
  }
  TemporaryDirectory directory;
  std::filesystem::path path = directory.path() / "journal";
};

JournalEntry accepted(const std::string& job) {
  return {.payload = "p", .attempt = 2, .server = "http://s:80", .job = job};
}

}  // namespace

TEST_CASE("a journal is read back as it was written") {
  const Folder folder;
  std::string batch;
  {
    Journal journal = folder.open();
    batch = journal.batch();
    REQUIRE(journal.put("a.glb", accepted("j1")));
    JournalEntry done = accepted("j2");
    done.result = KeptResult{"abc", 12};
    REQUIRE(journal.put("b.glb", done));
    JournalEntry failed = accepted("");
    failed.problem = Json{{"code", "invalid_mesh"}};
    REQUIRE(journal.put("c.glb", failed));
  }
  const Journal journal = folder.open();
  CHECK(journal.batch() == batch);
  CHECK(journal.entry("a.glb", "p").job == "j1");
  CHECK(journal.entry("a.glb", "p").attempt == 2);
  CHECK(journal.entry("a.glb", "p").server == "http://s:80");
  CHECK(journal.entry("b.glb", "p").result->sha256 == "abc");
  CHECK(journal.entry("b.glb", "p").result->bytes == 12);
  CHECK((*journal.entry("c.glb", "p").problem)["code"] == "invalid_mesh");
  CHECK(journal.wrote("b.glb"));
  CHECK_FALSE(journal.wrote("a.glb"));
}

TEST_CASE("another payload is another entry") {
  const Folder folder;
  Journal journal = folder.open();
  REQUIRE(journal.put("a.glb", accepted("j1")));
  const JournalEntry fresh = journal.entry("a.glb", "q");
  CHECK(fresh.job.empty());
  CHECK(fresh.payload == "q");
  CHECK(fresh.attempt == 1);
}

TEST_CASE("a line that a crash cut short is dropped, wherever it was cut") {
  const Folder folder;
  {
    Journal journal = folder.open();
    REQUIRE(journal.put("a.glb", accepted("j1")));
  }
  const std::string before = read_file(folder.path);
  {
    Journal journal = folder.open();
    REQUIRE(journal.put("a.glb", accepted("j2")));
  }
  const std::string whole = read_file(folder.path);
  for (std::size_t length = before.size(); length < whole.size(); ++length) {
    CAPTURE(length);
    std::ofstream(folder.path, std::ios::binary) << whole.substr(0, length);
    Journal journal = folder.open();
    CHECK(journal.entry("a.glb", "p").job == "j1");
    REQUIRE(journal.put("b.glb", accepted("j3")));
    const Journal again = folder.open();
    CHECK(again.entry("a.glb", "p").job == "j1");
    CHECK(again.entry("b.glb", "p").job == "j3");
  }
}

TEST_CASE("a journal whose first line was cut short begins anew") {
  const Folder folder;
  folder.append("{\"batch\":\"abc");
  CHECK(folder.open().batch().size() == 22);
}

TEST_CASE("what is no journal is refused and left as it is") {
  const Folder folder;
  const auto* text =
      GENERATE("hello\n", "hello", "{\"batch\":\"x\",\"version\":2}\n", "{\"file\":\"a\"}\n",
               "{\"batch\":\"x\",\"version\":1}\nhello\n{\"file\":\"a\",\"payload\":\"p\"}\n");
  folder.append(text);
  const auto journal = Journal::open(folder.path);
  REQUIRE_FALSE(journal);
  CHECK(journal.error().code == ErrorCode::usage);
  CHECK(read_file(folder.path) == text);
}
