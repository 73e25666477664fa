#include "server/fairwayd/store/data_directory.h"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "server/os/file.h"

namespace fairway {

Result<DataDirectory> DataDirectory::open(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return file_error(fmt::format("create {}", path.string()), error.value());
  auto lock = open_file(path / "lock", O_RDWR | O_CREAT);
  if (!lock) return lock.error();
  // A lock of the process, not of the open file: a worker that is just being spawned holds all
  // files for a moment, and must not hold this lock when its server is killed in that moment.
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (::fcntl(lock->get(), F_SETLK, &whole) == 0) return DataDirectory(path, std::move(*lock));
  if (errno != EAGAIN && errno != EACCES) {
    return file_error(fmt::format("lock {}", path.string()), errno);
  }
  return Error{ErrorCode::conflict,
               fmt::format("The data directory {} is in use by another fairwayd: stop that one, or "
                           "give this one a directory of its own with --data.",
                           path.string())};
}

}  // namespace fairway
