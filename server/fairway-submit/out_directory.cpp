#include "server/fairway-submit/out_directory.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>

#include "server/os/random_id.h"
#include "server/os/sha256.h"

namespace fairway {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOwnPrefix = ".fairway-submit";
constexpr std::string_view kPartPrefix = ".fairway-submit-part-";

void sweep(const fs::path& directory) {
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(directory, failed)) {
    if (!entry.path().filename().string().starts_with(kPartPrefix)) continue;
    // What cannot be removed costs room and nothing else.
    std::error_code ignored;
    fs::remove(entry.path(), ignored);
  }
}

}  // namespace

bool is_own_name(std::string_view name) {
  return name.starts_with(kOwnPrefix);
}

Result<OutDirectory> OutDirectory::open(const fs::path& path) {
  std::error_code failed;
  fs::create_directories(path, failed);
  auto lock = open_file(path, O_RDONLY | O_DIRECTORY);
  if (!lock) return Error{ErrorCode::usage, "--out: " + lock.error().message};
  if (::flock(lock->get(), LOCK_EX | LOCK_NB) != 0) {
    return Error{ErrorCode::usage,
                 errno == EWOULDBLOCK
                     ? fmt::format("Another fairway-submit works in {}.", path.string())
                     : system_sentence("lock " + path.string(), errno)};
  }
  sweep(path);
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return OutDirectory(path, *std::move(lock), 0666 & ~mask);
}

fs::path OutDirectory::journal() const {
  return path_ / (std::string(kOwnPrefix) + ".jsonl");
}

bool OutDirectory::has(const std::string& name) const {
  std::error_code failed;
  return fs::symlink_status(result(name), failed).type() != fs::file_type::not_found;
}

bool OutDirectory::holds(const std::string& name, const std::string& sha256) const {
  const auto fd = open_file(result(name), O_RDONLY | O_NOFOLLOW | O_NONBLOCK);
  if (!fd) return false;
  const auto found = sha256_of_file(fd->get());
  return found && *found == sha256;
}

Result<AtomicFile> OutDirectory::create_part() const {
  auto file = AtomicFile::create(path_ / (std::string(kPartPrefix) + random_id()));
  if (!file) return file.error();
  if (::fchmod(file->descriptor(), mode_) != 0) return file_error("set permissions", errno);
  return file;
}

}  // namespace fairway
