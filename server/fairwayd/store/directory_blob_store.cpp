#include "server/fairwayd/store/directory_blob_store.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <system_error>

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "server/os/file.h"
#include "server/os/kill_point.h"
#include "server/os/random_id.h"
#include "server/os/sha256.h"

namespace fairway {
namespace {

namespace fs = std::filesystem;

/// Keys are ours; one that could leave the directory is a defect, and is stopped here all the same.
bool is_plain(std::string_view key) {
  return !key.empty() && key.size() <= 100 && key.front() != '.' &&
         key.find('/') == std::string_view::npos && key.find('\0') == std::string_view::npos;
}

Error bad_key() {
  return {ErrorCode::internal, "A blob key is not a plain name."};
}

class FileDraft final : public BlobDraft {
 public:
  FileDraft(AtomicFile file, const fs::path& blobs) : file_(std::move(file)), blobs_(blobs) {}

  int descriptor() const override { return file_.descriptor(); }

  Result<void> append(std::span<const std::byte> bytes) override {
    kill_point("spool.write");
    return write_all(file_.descriptor(), bytes);
  }

  Result<BlobInfo> commit(std::string_view key) override {
    if (!is_plain(key)) return bad_key();
    auto bytes = size_of(file_.descriptor());
    if (!bytes) return bytes.error();
    begin_sync(file_.descriptor());  // the disk writes while the digest is computed
    auto sha256 = sha256_of_file(file_.descriptor());
    if (!sha256) return sha256.error();
    if (auto done = file_.commit(blobs_ / key); !done) return done.error();
    return BlobInfo{std::string(key), *bytes, std::move(*sha256)};
  }

 private:
  AtomicFile file_;
  const fs::path& blobs_;
};

Result<std::size_t> remove_files(const fs::path& directory, const std::vector<std::string>& keep) {
  std::size_t removed = 0;
  std::error_code error;
  fs::directory_iterator entries(directory, error);
  if (error) return file_error("list " + directory.string(), error.value());
  for (; entries != fs::directory_iterator(); entries.increment(error)) {
    const fs::path& path = entries->path();
    if (!std::binary_search(keep.begin(), keep.end(), path.filename().string())) {
      if (::unlink(path.c_str()) != 0) return file_error("remove " + path.string(), errno);
      ++removed;
    }
    if (error) return file_error("list " + directory.string(), error.value());
  }
  return removed;
}

}  // namespace

Result<std::unique_ptr<DirectoryBlobStore>> DirectoryBlobStore::open(const fs::path& blobs,
                                                                     const fs::path& spool) {
  for (const fs::path& directory : {blobs, spool}) {
    std::error_code error;
    fs::create_directories(directory, error);
    if (error) return file_error("create " + directory.string(), error.value());
    if (auto synced = sync_directory(directory.parent_path()); !synced) return synced.error();
  }
  return std::unique_ptr<DirectoryBlobStore>(new DirectoryBlobStore(blobs, spool));
}

Result<std::unique_ptr<BlobDraft>> DirectoryBlobStore::create() {
  auto file = AtomicFile::create(spool_ / random_id());
  if (!file) return file.error();
  return std::unique_ptr<BlobDraft>(std::make_unique<FileDraft>(std::move(*file), blobs_));
}

Result<BlobInfo> DirectoryBlobStore::copy_of(int file, std::string_view key) {
  auto draft = create();
  if (!draft) return draft.error();
  std::vector<std::byte> space(std::size_t{1} << 18);
  for (ssize_t got = 1; got > 0;) {
    got = ::read(file, space.data(), space.size());
    if (got < 0) return file_error("read a file", errno);
    const auto bytes = std::span(space).first(static_cast<std::size_t>(got));
    if (auto done = (*draft)->append(bytes); !done) return done.error();
  }
  return (*draft)->commit(key);
}

/// A second name for the file; a copy where the file systems have none to give.
Result<BlobInfo> DirectoryBlobStore::adopt(const fs::path& file, std::string_view key) {
  if (!is_plain(key)) return bad_key();
  auto fd = open_file(file, O_RDONLY);
  if (!fd) return fd.error();
  auto bytes = size_of(fd->get());
  if (!bytes) return bytes.error();
  auto sha256 = sha256_of_file(fd->get());
  if (!sha256) return sha256.error();
  if (::fsync(fd->get()) != 0) return file_error("make a payload durable", errno);
  if (::link(file.c_str(), (blobs_ / key).c_str()) != 0) return copy_of(fd->get(), key);
  if (auto synced = sync_directory(blobs_); !synced) return synced.error();
  return BlobInfo{std::string(key), *bytes, std::move(*sha256)};
}

Result<UniqueFd> DirectoryBlobStore::open(std::string_view key) {
  if (!is_plain(key)) return bad_key();
  const fs::path path = blobs_ / key;
  UniqueFd fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (fd) return fd;
  if (errno == ENOENT) return Error{ErrorCode::gone, "The payload is no longer stored."};
  return file_error("open a payload", errno);
}

Result<void> DirectoryBlobStore::remove(std::string_view key) {
  if (!is_plain(key)) return bad_key();
  if (::unlink((blobs_ / key).c_str()) != 0 && errno != ENOENT) {
    return file_error("remove a payload", errno);
  }
  return {};
}

Result<std::uint64_t> DirectoryBlobStore::free_bytes() {
  struct statvfs disk {};
  if (::statvfs(spool_.c_str(), &disk) != 0) return file_error("measure the disk", errno);
  return std::uint64_t{disk.f_bavail} * disk.f_frsize;
}

Result<std::size_t> DirectoryBlobStore::sweep(const std::vector<std::string>& needed) {
  std::vector<std::string> keep = needed;
  std::sort(keep.begin(), keep.end());
  auto drafts = remove_files(spool_, {});
  if (!drafts) return drafts.error();
  auto blobs = remove_files(blobs_, keep);
  if (!blobs) return blobs.error();
  return *drafts + *blobs;
}

}  // namespace fairway
