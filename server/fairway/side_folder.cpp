// Files beside a document, opened name by name so that nothing leads out of its folder.

#include "server/fairway/side_folder.h"

#include <cerrno>
#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>

#include "server/os/file.h"
#include "server/os/unique_fd.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxFiles = 4096;

Error unreadable(const std::string& path, int error_number) {
  return {ErrorCode::io,
          system_sentence(fmt::format("open {} beside the document", path), error_number)};
}

/// O_NONBLOCK: a pipe must not make us wait before it is found to be no regular file.
Result<UniqueFd> open_beneath(UniqueFd folder, const std::string& path) {
  for (std::size_t start = 0;;) {
    const std::size_t end = path.find('/', start);
    const bool last = end == std::string::npos;
    const std::string name = path.substr(start, end - start);
    const int flags = O_RDONLY | O_CLOEXEC | O_NOFOLLOW | (last ? O_NONBLOCK : O_DIRECTORY);
    UniqueFd next(name == ".." ? -1 : openat(folder.get(), name.c_str(), flags));
    if (!next) return unreadable(path, name == ".." ? EACCES : errno);
    if (last) return next;
    folder = std::move(next);
    start = end + 1;
  }
}

}  // namespace

SideFiles SideFolder::provider() {
  return [this](const std::string& path) { return read(path); };
}

Result<ByteSpan> SideFolder::read(const std::string& path) {
  if (const auto found = files_.find(path); found != files_.end()) return found->second.bytes();
  if (files_.size() >= kMaxFiles) {
    return Error{ErrorCode::too_large,
                 fmt::format("The document names more than {} files.", kMaxFiles)};
  }
  const std::filesystem::path folder = std::filesystem::path(document_).parent_path();
  auto directory = open_file(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  if (!directory) return directory.error();
  const auto fd = open_beneath(*std::move(directory), path);
  if (!fd) return fd.error();
  auto file = InputFile::map(fd->get());
  if (!file) return Error{file.error().code, fmt::format("{}: {}", path, file.error().message)};
  return files_.emplace(path, *std::move(file)).first->second.bytes();
}

}  // namespace fairway
