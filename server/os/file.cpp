#include "server/os/file.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include "server/os/kill_point.h"

namespace fairway {

std::string system_sentence(std::string_view doing, int error_number) {
  return fmt::format("Cannot {}: {}.", doing, std::generic_category().message(error_number));
}

Error file_error(std::string_view doing, int error_number) {
  const bool full = error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG;
  return {full ? ErrorCode::storage_full : ErrorCode::io, system_sentence(doing, error_number)};
}

Result<UniqueFd> open_file(const std::filesystem::path& path, int flags, mode_t mode) {
  UniqueFd fd(::open(path.c_str(), flags | O_CLOEXEC, mode));
  if (!fd) return file_error(fmt::format("open {}", path.string()), errno);
  return fd;
}

/// O_NONBLOCK: a pipe must not make us wait before it is found to be no regular file.
Result<UniqueFd> open_beneath(UniqueFd folder, const std::string& path) {
  const auto unreadable = [&path](int error_number) {
    return Error{ErrorCode::io,
                 system_sentence(fmt::format("open {} beside the document", path), error_number)};
  };
  for (std::size_t start = 0;;) {
    const std::size_t end = path.find('/', start);
    const bool last = end == std::string::npos;
    const std::string name = path.substr(start, end - start);
    const int flags = O_RDONLY | O_CLOEXEC | O_NOFOLLOW | (last ? O_NONBLOCK : O_DIRECTORY);
    UniqueFd next(name == ".." ? -1 : ::openat(folder.get(), name.c_str(), flags));
    if (!next) return unreadable(name == ".." ? EACCES : errno);
    if (last) return next;
    folder = std::move(next);
    start = end + 1;
  }
}

Result<void> write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return file_error("write", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> write_all(int fd, std::span<const std::span<const std::byte>> pieces) {
  constexpr std::size_t kMost = IOV_MAX;
  std::vector<iovec> batch;
  while (!pieces.empty()) {
    const auto now = pieces.first(std::min(pieces.size(), kMost));
    batch.clear();
    for (const auto piece : now) {
      batch.push_back({const_cast<std::byte*>(piece.data()), piece.size()});
    }
    const ssize_t written = ::writev(fd, batch.data(), static_cast<int>(batch.size()));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return file_error("write", errno);
    auto left = static_cast<std::size_t>(written);
    for (; !pieces.empty() && left >= pieces.front().size(); pieces = pieces.subspan(1)) {
      left -= pieces.front().size();
    }
    if (left == 0) continue;
    // The system stopped inside a piece: its rest by itself.
    if (auto done = write_all(fd, pieces.front().subspan(left)); !done) return done;
    pieces = pieces.subspan(1);
  }
  return {};
}

Result<void> sync_directory(const std::filesystem::path& directory) {
  auto fd = open_file(directory, O_RDONLY | O_DIRECTORY);
  if (!fd) return fd.error();
  if (::fsync(fd->get()) != 0) return file_error("make a directory durable", errno);
  return {};
}

Result<std::uint64_t> size_of(int fd) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) return file_error("look at a file", errno);
  return static_cast<std::uint64_t>(status.st_size);
}

void begin_sync(int fd) {
  (void)::sync_file_range(fd, 0, 0, SYNC_FILE_RANGE_WRITE);
}

Result<AtomicFile> AtomicFile::create(std::filesystem::path temporary) {
  auto fd = open_file(temporary, O_RDWR | O_CREAT | O_EXCL);
  if (!fd) return fd.error();
  kill_point("file.created");
  return AtomicFile(std::move(temporary), std::move(*fd));
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : temporary_(std::exchange(other.temporary_, {})), fd_(std::move(other.fd_)) {}

AtomicFile::~AtomicFile() {
  // A file that cannot be removed here is swept at the next start.
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

Result<void> AtomicFile::rename_to(const std::filesystem::path& final_path) {
  kill_point("file.rename");
  if (std::rename(temporary_.c_str(), final_path.c_str()) != 0) {
    return file_error("give a file its final name", errno);
  }
  temporary_.clear();
  return {};
}

Result<void> AtomicFile::commit(const std::filesystem::path& final_path) {
  kill_point("file.fsync");
  if (::fsync(fd_.get()) != 0) return file_error("make a file durable", errno);
  if (auto done = rename_to(final_path); !done) return done;
  const std::filesystem::path directory = final_path.parent_path();
  kill_point("file.sync_directory");
  if (auto done = sync_directory(directory.empty() ? "." : directory); !done) return done;
  kill_point("file.synced");
  return {};
}

}  // namespace fairway
