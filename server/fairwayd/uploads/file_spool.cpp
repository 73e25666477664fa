#include "server/fairwayd/uploads/file_spool.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "proto/messages/bundle.h"
#include "proto/messages/json.h"

namespace fairway {
namespace {

Error bad_request(std::string what) {
  return {ErrorCode::bad_request, std::move(what)};
}

}  // namespace

Error upload_too_large(std::uint64_t limit) {
  return {ErrorCode::too_large,
          fmt::format("The mesh is larger than the {} bytes this server takes.", limit)};
}

Result<void> FileSpool::begin(const PartHead& part) {
  const std::string& name = part.file_name.empty() ? part.name : part.file_name;
  if (auto checked = check_bundle_name(name); !checked) return checked;
  const bool is_part_mesh = part.name == "mesh";
  for (const File& file : files_) {
    if (is_part_mesh && file.is_part_mesh) {
      return bad_request("At most one part is named mesh: the one with the mesh itself.");
    }
    if (file.name == name) {
      return bad_request(fmt::format("Two parts have the file name \"{}\"; send it once.", name));
    }
  }
  if (files_.size() == kMaxBundleFiles) {
    return bad_request(fmt::format("An upload has at most {} files.", kMaxBundleFiles));
  }
  if (!files_.empty()) {
    if (auto ended = end_file(); !ended) return ended;
  }
  files_.push_back({name, part.content_type, is_part_mesh, 0, {}});
  return {};
}

/// The digest of the last file. Only the second one makes it worth having, so that the first is
/// read once more.
Result<void> FileSpool::end_file() {
  if (files_.size() > 1) {
    files_.back().sha256 = std::exchange(hash_, Sha256()).hex();
    return {};
  }
  auto sha256 = sha256_of_file(draft_.descriptor());
  if (!sha256) return sha256.error();
  files_.back().sha256 = *std::move(sha256);
  return {};
}

std::string FileSpool::digest(std::size_t mesh) const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < files_.size(); ++i) {
    lines.push_back(dump_json(Json{files_[i].name, files_[i].sha256, i == mesh}));
  }
  std::sort(lines.begin(), lines.end());
  Sha256 hash;
  for (const std::string& line : lines) hash.update(std::as_bytes(std::span(line)));
  return hash.hex();
}

Result<void> FileSpool::append(std::span<const std::byte> bytes) {
  if (files_.empty()) return bad_request("The upload has bytes before its first part.");
  if (bytes.size() > limit_ - count_) return upload_too_large(limit_);
  File& file = files_.back();
  count_ += bytes.size();
  file.bytes += bytes.size();
  const std::size_t wanted = std::min(bytes.size(), kMagicBytes - file.head.size());
  const auto first = bytes.first(wanted);
  file.head.insert(file.head.end(), first.begin(), first.end());
  // What is surely the mesh is refused before the rest of it has come.
  if (file.is_part_mesh && wanted > 0 && file.head.size() == kMagicBytes) {
    if (auto format = recognise(file); !format) return format.error();
  }
  if (files_.size() > 1) hash_.update(bytes);
  return draft_.append(bytes);
}

Result<SpooledFiles> FileSpool::finish() {
  const auto mesh = find_mesh();
  if (!mesh) return mesh.error();
  const auto format = recognise(files_[*mesh]);
  if (!format) return format.error();
  if (files_.size() > 1) {
    std::vector<BundleEntry> entries;
    entries.reserve(files_.size());
    for (const File& file : files_) entries.push_back({file.name, file.bytes});
    const std::string end = bundle_end(entries, *mesh);
    if (auto ended = end_file(); !ended) return ended.error();
    if (auto done = draft_.append(std::as_bytes(std::span(end))); !done) return done.error();
  }
  return SpooledFiles{*format, files_.size(), files_.size() > 1 ? digest(*mesh) : std::string()};
}

Result<Format> FileSpool::recognise(const File& file) {
  return recognise_format(file.head, file.type, file.name);
}

/// The more, the plainer; 0: nothing says so.
int FileSpool::claim_to_be_mesh(const File& file) {
  if (file.is_part_mesh) return 3;
  if (format_of_file_name(file.name)) return 2;
  return recognise(file) ? 1 : 0;
}

Result<std::size_t> FileSpool::find_mesh() const {
  if (files_.empty()) return bad_request("The multipart upload has no part with a mesh.");
  if (files_.size() == 1) return 0;
  std::vector<int> claims;
  claims.reserve(files_.size());
  for (const File& file : files_) claims.push_back(claim_to_be_mesh(file));
  const auto best = std::max_element(claims.begin(), claims.end());
  if (*best == 0 || std::count(claims.begin(), claims.end(), *best) > 1) {
    return bad_request(fmt::format(
        "{} of the uploaded files may be the mesh; name the part of the right one mesh.",
        *best == 0 ? "None" : "Several"));
  }
  return static_cast<std::size_t>(best - claims.begin());
}

}  // namespace fairway
