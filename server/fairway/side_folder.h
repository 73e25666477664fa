#pragma once

#include <map>
#include <string>

#include "core/result.h"
#include "proto/formats/side_files.h"
#include "server/fairway/input_file.h"

namespace fairway {

/// The files beside a document that a person names. Only regular files in its folder and below are
/// opened: every name on the way is opened in the directory before it, and never through a symbolic
/// link. Must outlive the Documents that it gives bytes to.
class SideFolder {
 public:
  /// The folder of `document`; nothing is opened before the first file is asked for.
  explicit SideFolder(std::string document) : document_(std::move(document)) {}

  SideFolder(const SideFolder&) = delete;
  SideFolder& operator=(const SideFolder&) = delete;

  /// Asks this folder.
  SideFiles provider();

 private:
  Result<ByteSpan> read(const std::string& path);

  std::string document_;
  std::map<std::string, InputFile> files_;
};

}  // namespace fairway
