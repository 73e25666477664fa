// The files of a bundle as the side files of its mesh.

#include "server/fairway/bundled_files.h"

#include <algorithm>

#include <fmt/format.h>

namespace fairway {
namespace {

/// Every mention of a file becomes bytes of the result: a small upload must not become a huge one.
constexpr std::uint64_t kRepetitions = 4;
constexpr std::uint64_t kAlwaysGiven = std::uint64_t{64} << 20;

/// A longer one is the name of no part.
std::string shown(const std::string& path) {
  return path.size() <= kMaxBundleName ? path : path.substr(0, kMaxBundleName) + "…";
}

}  // namespace

SideFiles BundledFiles::provider() {
  return [this](const std::string& path) { return read(path); };
}

Result<ByteSpan> BundledFiles::read(const std::string& path) {
  const std::vector<BundledFile>& files = bundle_.files();
  std::uint64_t all = 0;
  for (const BundledFile& file : files) all += file.bytes.size();
  const auto found = std::find_if(files.begin(), files.end(),
                                  [&path](const BundledFile& file) { return file.name == path; });
  if (found == files.end()) {
    return Error{ErrorCode::invalid_mesh,
                 fmt::format("The document names \"{}\", and no part of the upload has this file "
                             "name; add one.",
                             shown(path))};
  }
  asked_for_.at(static_cast<std::size_t>(found - files.begin())) = true;
  given_ += found->bytes.size();
  if (given_ > std::max(kRepetitions * all, kAlwaysGiven)) {
    return Error{ErrorCode::too_large,
                 "The document names the uploaded files too often; name each of them once."};
  }
  return found->bytes;
}

std::vector<std::string> BundledFiles::notes() const {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < bundle_.files().size(); ++i) {
    if (i == bundle_.mesh() || asked_for_.at(i)) continue;
    out.push_back(fmt::format("the uploaded file \"{}\" was not needed and is not in the result",
                              bundle_.files()[i].name));
  }
  return out;
}

}  // namespace fairway
