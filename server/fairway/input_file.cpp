// Files of the tool: mapped in, replaced atomically.

#include "server/fairway/input_file.h"

#include <cerrno>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "server/os/file.h"
#include "server/os/random_id.h"

namespace fairway {

Result<InputFile> InputFile::open(const std::string& path) {
  const Result<UniqueFd> fd = open_file(path, O_RDONLY);
  if (!fd) return fd.error();
  return map(fd->get());
}

Result<InputFile> InputFile::map(int fd) {
  struct stat status = {};
  if (fstat(fd, &status) != 0) return file_error("read the input", errno);
  if (!S_ISREG(status.st_mode)) return Error{ErrorCode::io, "The input is not a regular file."};
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return InputFile({});
  void* data = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  if (data == MAP_FAILED) return file_error("map the input", errno);
  return InputFile({static_cast<const std::byte*>(data), size});
}

InputFile::~InputFile() {
  if (!bytes_.empty()) munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

Result<Format> format_of_output(const std::string& file_name) {
  if (const auto named = format_of_file_name(file_name)) return *named;
  return Error{
      ErrorCode::usage,
      fmt::format("The extension of {} names no format; use .glb, .gltf, .drc, .ply, .obj or "
                  ".stl.",
                  file_name)};
}

Result<void> write_file(const std::string& path, const ByteChain& bytes) {
  Result<AtomicFile> file = AtomicFile::create(path + ".tmp-" + random_id());
  if (!file) return file.error();
  if (Result<void> written = write_all(file->descriptor(), bytes.pieces()); !written) {
    return written;
  }
  if (Result<void> renamed = file->rename_to(path); !renamed) return renamed;
  // AtomicFile makes private files; what a person asked for gets the usual permissions.
  const mode_t mask = umask(0);
  umask(mask);
  std::error_code ignored;
  std::filesystem::permissions(path, static_cast<std::filesystem::perms>(0666 & ~mask), ignored);
  return {};
}

}  // namespace fairway
