#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "proto/formats/side_files.h"
#include "proto/messages/bundle.h"

namespace fairway {

/// The files that were uploaded together with a mesh, by name. No file system is asked. Must
/// outlive the Documents that it gives bytes to.
class BundledFiles {
 public:
  explicit BundledFiles(Bundle bundle) : bundle_(std::move(bundle)) {}

  BundledFiles(const BundledFiles&) = delete;
  BundledFiles& operator=(const BundledFiles&) = delete;

  ByteSpan mesh() const { return bundle_.files()[bundle_.mesh()].bytes; }

  /// Asks these files. Errors: invalid_mesh (no part has this name), too_large (a document that
  /// names its files over and over, to become many times the upload).
  SideFiles provider();

  /// One sentence for each file beside the mesh that has not been asked for.
  std::vector<std::string> notes() const;

 private:
  Result<ByteSpan> read(const std::string& path);

  Bundle bundle_;
  std::array<bool, kMaxBundleFiles> asked_for_ = {};
  std::uint64_t given_ = 0;  ///< bytes, repetitions counted
};

}  // namespace fairway
