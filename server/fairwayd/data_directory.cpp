#include "server/fairwayd/data_directory.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include "server/os/file.h"

namespace fairway {

Result<DataDirectory> DataDirectory::open(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return file_error(fmt::format("create {}", path.string()), error.value());
  auto lock = open_file(path / "lock", O_RDWR | O_CREAT);
  if (!lock) return lock.error();
  if (::flock(lock->get(), LOCK_EX | LOCK_NB) == 0) return DataDirectory(path, std::move(*lock));
  if (errno != EWOULDBLOCK) return file_error(fmt::format("lock {}", path.string()), errno);
  return Error{ErrorCode::conflict,
               fmt::format("The data directory {} is in use by another fairwayd: stop that one, or "
                           "give this one a directory of its own with --data.",
                           path.string())};
}

}  // namespace fairway
