// Files beside a document, opened name by name so that nothing leads out of its folder.

#include "server/fairway/side_folder.h"

#include <filesystem>

#include <fcntl.h>
#include <fmt/format.h>

#include "server/os/file.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxFiles = 4096;

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
