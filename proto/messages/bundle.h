#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace fairway {

/// A bundle is several uploaded files as one payload, so that a job has one input:
///
///   bytes of file 0 | … | bytes of file n − 1 | directory | footer
///
/// The directory is JSON, {"mesh": i, "files": [{"name": "scene.gltf", "bytes": 1234}, …]}, in the
/// order of the bytes. The footer has 16 bytes: "FWBUNDLE", the version and the length of the
/// directory, both u32, little-endian. What describes the files stands behind them, so a writer
/// appends them as they arrive and copies nothing.

/// Most files of a bundle.
inline constexpr std::size_t kMaxBundleFiles = 16;
/// Longest name of a file in it, in bytes.
inline constexpr std::size_t kMaxBundleName = 255;

/// A file in the directory of a bundle.
struct BundleEntry {
  std::string name;
  std::uint64_t bytes = 0;
};

/// A name is UTF-8 of 1 to kMaxBundleName bytes without control characters. It is compared with
/// names in documents and means nothing to a file system. Error: bad_request.
Result<void> check_bundle_name(std::string_view name);

/// Directory and footer, to be appended to the bytes of `files` in their order. The names have
/// passed check_bundle_name() and differ; `mesh` is the index of the file that is the job's mesh.
std::string bundle_end(std::span<const BundleEntry> files, std::size_t mesh);

/// A file inside a bundle.
struct BundledFile {
  std::string name;
  std::span<const std::byte> bytes;
};

/// A bundle as it is read: views of its payload.
class Bundle {
 public:
  /// Believes nothing: magic, version, every count and length is checked before it is used, and all
  /// bytes must be accounted for. `bytes` must outlive the Bundle. Error: malformed_input.
  static Result<Bundle> parse(std::span<const std::byte> bytes);

  /// 1 to kMaxBundleFiles, with different names.
  const std::vector<BundledFile>& files() const { return files_; }
  /// The index of the job's mesh in files().
  std::size_t mesh() const { return mesh_; }

 private:
  std::vector<BundledFile> files_;
  std::size_t mesh_ = 0;
};

}  // namespace fairway
