#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"
#include "server/os/unique_fd.h"

namespace fairway {

/// A file that a glTF names.
struct SceneFile {
  std::string name;  ///< its path below the folder of the document
  UniqueFd file;
};

/// The files that buffers and images of a .gltf name in its folder and below, each once. What
/// cannot be opened there, or leads elsewhere, is left out: the server says whether it is needed.
/// Empty where the text is no JSON object. Errors: io.
Result<std::vector<SceneFile>> open_scene_files(const std::filesystem::path& document,
                                                const std::string& text);

}  // namespace fairway
