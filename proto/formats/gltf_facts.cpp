// What stands in a glTF beside positions and triangles.

#include "proto/formats/gltf_facts.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "proto/formats/gltf_extensions.h"

namespace fairway {
namespace {

const Json& list_at(const Json& object, const char* key) {
  static const Json none = Json::array();
  if (!object.is_object()) return none;
  const auto it = object.find(key);
  return it != object.end() && it->is_array() ? *it : none;
}

template <class Test>
std::size_t count_if(const Json& list, Test test) {
  return static_cast<std::size_t>(std::count_if(list.begin(), list.end(), test));
}

bool has_extension(const Json& json, const char* name) {
  return json.is_object() && json.contains("extensions") && json["extensions"].is_object() &&
         json["extensions"].contains(name);
}

bool is_placed(const Json& node) {
  constexpr std::array<const char*, 4> kKeys = {"matrix", "translation", "rotation", "scale"};
  return node.is_object() && std::any_of(kKeys.begin(), kKeys.end(),
                                         [&](const char* key) { return node.contains(key); });
}

bool is_drawn(const Json& node) {
  return node.is_object() && node.contains("mesh");
}

/// Attributes that a new file does not carry.
bool has_other_attributes(const Json& primitive, const ExtraKinds& extras) {
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end() || !attributes->is_object()) return false;
  for (const auto& [name, accessor] : attributes->items()) {
    const bool carried = name == "POSITION" || name == "NORMAL" ||
                         (name == "COLOR_0" && extras.color_components > 0) ||
                         (name == "TEXCOORD_0" && extras.texture_coordinates);
    if (!carried) return true;
  }
  return false;
}

bool has_lines_or_points(const Json& primitive) {
  const auto mode = primitive.find("mode");
  return mode != primitive.end() && mode->is_number() && *mode < 4;
}

/// Primitives of all meshes that a test holds for.
template <class Test>
std::size_t count_primitives(const Json& root, Test test) {
  std::size_t count = 0;
  for (const Json& mesh : list_at(root, "meshes")) {
    count += count_if(list_at(mesh, "primitives"), test);
  }
  return count;
}

std::vector<std::string> left_behind(const Json& root, const ExtraKinds& extras) {
  std::vector<std::string> out;
  const auto add = [&out](std::size_t count, std::string_view name) {
    if (count > 0) out.push_back(counted(count, name));
  };
  add(list_at(root, "materials").size(), "material");
  add(list_at(root, "textures").size(), "texture");
  add(list_at(root, "skins").size(), "skin");
  add(list_at(root, "animations").size(), "animation");
  const auto has_others = [&](const Json& p) { return has_other_attributes(p, extras); };
  if (count_primitives(root, has_others) > 0) out.emplace_back("other attributes");
  if (count_primitives(root, [](const Json& p) { return p.contains("targets"); }) > 0) {
    out.emplace_back("morph targets");
  }
  add(count_primitives(root, has_lines_or_points), "primitive of points or lines");
  if (count_if(list_at(root, "nodes"), is_placed) > 0) out.emplace_back("transformations of nodes");
  const std::size_t drawn = count_if(list_at(root, "nodes"), is_drawn);
  if (drawn > 1) out.push_back(fmt::format("the {} places where the scene shows it", drawn));
  return out;
}

std::vector<std::string> untouched(const Json& root) {
  std::vector<std::string> out;
  const std::size_t draco =
      count_primitives(root, [](const Json& p) { return has_extension(p, kDracoExtension); });
  if (draco > 0) {
    out.push_back(fmt::format(
        "{} compressed with Draco: what moves comes back plain, unless \"compression\" asks for "
        "keep or draco.",
        counted(draco, "primitive")));
  }
  const std::size_t meshopt = count_if(list_at(root, "bufferViews"), [](const Json& view) {
    return has_extension(view, kMeshoptExtension) || has_extension(view, kNewerMeshoptExtension);
  });
  if (meshopt > 0) {
    out.push_back(
        fmt::format("{} compressed with meshopt: what moves comes back plain, unless "
                    "\"compression\" asks for keep or meshopt.",
                    counted(meshopt, "buffer view")));
  }
  const std::size_t animations = list_at(root, "animations").size();
  if (animations > 0) {
    out.push_back(fmt::format("{}: kept as they are.", counted(animations, "animation")));
  }
  return out;
}

}  // namespace

FileFacts gltf_facts(const Json& root, const ExtraKinds& extras) {
  FileFacts out;
  out.meshes = list_at(root, "meshes").size();
  out.primitives = count_primitives(root, [](const Json&) { return true; });
  out.left_behind = left_behind(root, extras);
  out.extras = extras;
  out.untouched = untouched(root);
  return out;
}

}  // namespace fairway
