// The contract of BlobStore, and what DirectoryBlobStore leaves on disk.
#include <fstream>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>
#include <unistd.h>

#include "server/fairwayd/store/directory_blob_store.h"
#include "server/os/random_id.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;

namespace {

class Fixture {
 public:
  Fixture() {
    auto opened = DirectoryBlobStore::open(blobs(), spool());
    REQUIRE(opened);
    store_ = std::move(*opened);
  }
  std::filesystem::path blobs() const { return directory_.path() / "blobs"; }
  std::filesystem::path spool() const { return directory_.path() / "spool"; }
  BlobStore& store() { return *store_; }

  static std::span<const std::byte> bytes(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
  }
  BlobInfo put(std::string_view key, std::string_view text) {
    auto draft = store().create();
    REQUIRE(draft);
    REQUIRE((*draft)->append(bytes(text)));
    auto info = (*draft)->commit(key);
    REQUIRE(info);
    return *info;
  }
  std::string get(std::string_view key) {
    auto file = store().open(key);
    REQUIRE(file);
    std::string text(100, '\0');
    const ssize_t got = ::read(file->get(), text.data(), text.size());
    REQUIRE(got >= 0);
    text.resize(static_cast<std::size_t>(got));
    return text;
  }

 private:
  test::TemporaryDirectory directory_;
  std::unique_ptr<BlobStore> store_;
};

bool has_files(const std::filesystem::path& directory) {
  return std::filesystem::directory_iterator(directory) != std::filesystem::directory_iterator();
}

}  // namespace

TEST_CASE("a committed blob reads back, with its size and digest") {
  Fixture f;
  const BlobInfo info = f.put("in-a", "abc");
  CHECK(info.key == "in-a");
  CHECK(info.bytes == 3);
  CHECK(info.sha256 == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(f.get("in-a") == "abc");
  CHECK_FALSE(has_files(f.spool()));
}

TEST_CASE("a dropped draft leaves nothing") {
  Fixture f;
  {
    auto draft = f.store().create();
    REQUIRE(draft);
    REQUIRE((*draft)->append(Fixture::bytes("abc")));
    CHECK(has_files(f.spool()));
  }
  CHECK_FALSE(has_files(f.spool()));
  CHECK_FALSE(has_files(f.blobs()));
}

TEST_CASE("what a process writes to a draft's descriptor is part of the blob") {
  Fixture f;
  auto draft = f.store().create();
  REQUIRE(draft);
  REQUIRE(::write((*draft)->descriptor(), "xyz", 3) == 3);
  const auto info = (*draft)->commit("out");
  REQUIRE(info);
  CHECK(info->bytes == 3);
  CHECK(f.get("out") == "xyz");
}

TEST_CASE("a removed blob is gone, stays readable where it is open, and may be removed again") {
  Fixture f;
  f.put("in-a", "abc");
  const auto open = f.store().open("in-a");
  REQUIRE(open);
  REQUIRE(f.store().remove("in-a"));
  REQUIRE(f.store().remove("in-a"));
  const auto gone = f.store().open("in-a");
  REQUIRE_FALSE(gone);
  CHECK(gone.error().code == ErrorCode::gone);
  char text[4] = {};
  CHECK(::read(open->get(), text, 3) == 3);
}

TEST_CASE("a key cannot leave the store") {
  Fixture f;
  for (const char* key : {"../x", "a/b", "", ".", "..", ".hidden"}) {
    CAPTURE(key);
    CHECK_FALSE(f.store().open(key));
    CHECK_FALSE(f.store().remove(key));
    auto draft = f.store().create();
    REQUIRE(draft);
    CHECK_FALSE((*draft)->commit(key));
  }
}

TEST_CASE("the sweep removes orphans and old drafts, and nothing that is needed") {
  Fixture f;
  f.put("in-a", "a");
  f.put("in-b", "b");
  f.put("out-c", "c");
  std::ofstream(f.spool() / "left-behind") << "half a draft";
  const auto removed = f.store().sweep({"out-c", "in-a"});
  REQUIRE(removed);
  CHECK(*removed == 2);
  CHECK(f.get("in-a") == "a");
  CHECK(f.get("out-c") == "c");
  CHECK_FALSE(f.store().open("in-b"));
  CHECK_FALSE(has_files(f.spool()));
}

TEST_CASE("a file is adopted with all its bytes, and may go afterwards") {
  Fixture f;
  const std::filesystem::path file = f.blobs().parent_path() / "mesh";
  std::ofstream(file) << "a mesh";
  const auto info = f.store().adopt(file, "in-1");
  REQUIRE(info);
  CHECK(info->bytes == 6);
  CHECK(info->sha256 == f.put("other", "a mesh").sha256);
  CHECK(std::filesystem::hard_link_count(file) == 2);
  REQUIRE(std::filesystem::remove(file));
  CHECK(f.get("in-1") == "a mesh");
  CHECK_FALSE(f.store().adopt(file, "in-2"));
}

TEST_CASE("a file of another file system is adopted as a copy") {
  Fixture f;
  // Memory, where the temporary directory is a disk; nothing to try where it is not.
  const std::filesystem::path shared = "/dev/shm";
  if (!std::filesystem::is_directory(shared)) return;
  const std::filesystem::path file = shared / ("fairway-" + random_id());
  std::ofstream(file) << "a mesh";
  const auto info = f.store().adopt(file, "in-1");
  std::filesystem::remove(file);
  REQUIRE(info);
  CHECK(f.get("in-1") == "a mesh");
  CHECK_FALSE(has_files(f.spool()));
}
