#include "server/fairway-submit/scene_files.h"

#include <set>
#include <utility>

#include <fcntl.h>

#include "proto/formats/side_files.h"
#include "proto/messages/bundle.h"
#include "server/fairway-submit/json_fields.h"
#include "server/os/file.h"

namespace fairway {
namespace {

constexpr std::string_view kData = "data:";

/// A name that a form can carry as it is.
bool is_sendable(const std::string& name) {
  return name.find_first_of("\"\\") == std::string::npos &&
         static_cast<bool>(check_bundle_name(name));
}

void collect(const Json& root, const char* list, std::set<std::string>& names) {
  const auto found = root.find(list);
  if (found == root.end() || !found->is_array()) return;
  for (const Json& item : *found) {
    const std::string uri = text_in(item, "uri");
    if (uri.empty() || uri.starts_with(kData)) continue;
    if (auto path = path_of_uri(uri); path && is_sendable(*path)) names.insert(*std::move(path));
  }
}

}  // namespace

Result<std::vector<SceneFile>> open_scene_files(const std::filesystem::path& document,
                                                const std::string& text) {
  std::vector<SceneFile> files;
  const auto root = parse_json(text);
  if (!root || !root->is_object()) return files;
  std::set<std::string> names;
  collect(*root, "buffers", names);
  collect(*root, "images", names);
  const auto folder = document.parent_path();
  for (const std::string& name : names) {
    auto directory = open_file(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
    if (!directory) return directory.error();
    auto file = open_beneath(*std::move(directory), name);
    if (file) files.push_back({name, *std::move(file)});
  }
  return files;
}

}  // namespace fairway
