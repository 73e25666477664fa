// Which required extensions leave the meaning of meshes alone.

#include "proto/formats/gltf_extensions.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace fairway {
namespace {

/// Families that describe looks, light or behaviour.
constexpr std::array<std::string_view, 12> kHarmlessFamilies = {
    "KHR_materials_", "KHR_texture_", "EXT_texture_",     "MSFT_texture_",
    "MSFT_packing_",  "KHR_lights_",  "EXT_lights_",      "KHR_node_",
    "KHR_xmp",        "VRMC_",        "ADOBE_materials_", "KHR_audio"};

/// Extensions that fairway decodes, or that leave vertices and triangles as they stand. What a
/// triangle primitive needs of meshopt is refused where it is read.
constexpr std::array<std::string_view, 16> kKnown = {"KHR_draco_mesh_compression",
                                                     "KHR_mesh_quantization",
                                                     "EXT_meshopt_compression",
                                                     "KHR_meshopt_compression",
                                                     "KHR_animation_pointer",
                                                     "EXT_mesh_gpu_instancing",
                                                     "EXT_mesh_features",
                                                     "EXT_mesh_manifold",
                                                     "EXT_instance_features",
                                                     "EXT_structural_metadata",
                                                     "KHR_techniques_webgl",
                                                     "KHR_interactivity",
                                                     "CESIUM_primitive_outline",
                                                     "CESIUM_RTC",
                                                     "MSFT_lod",
                                                     "VRM"};

bool leaves_geometry(std::string_view name) {
  return std::find(kKnown.begin(), kKnown.end(), name) != kKnown.end() ||
         std::any_of(kHarmlessFamilies.begin(), kHarmlessFamilies.end(),
                     [name](std::string_view family) { return name.starts_with(family); });
}

/// The list at `key`, if it is there, all of it strings.
Result<std::optional<JsonPlace>> names(const JsonPlace& root, std::string_view key) {
  auto list = root.array(key);
  if (!list || !*list) return list;
  for (std::size_t i = 0; i < (*list)->size(); ++i) {
    const JsonPlace place = (**list)[i];
    if (!place.json().is_string()) return place.error("extensions are named by strings.");
  }
  return list;
}

}  // namespace

Result<void> check_extensions(const JsonPlace& root) {
  if (const auto used = names(root, "extensionsUsed"); !used) return used.error();
  const auto required = names(root, "extensionsRequired");
  if (!required) return required.error();
  for (std::size_t i = 0; *required && i < (*required)->size(); ++i) {
    const JsonPlace place = (**required)[i];
    if (!leaves_geometry(place.json().get_ref<const std::string&>())) {
      return Error{ErrorCode::unsupported_feature,
                   "The file requires an extension that fairway does not know; save it without "
                   "that extension.",
                   place.pointer()};
    }
  }
  return {};
}

bool uses_extension(const JsonPlace& root, std::string_view name) {
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    const auto list = root.find(key);
    if (!list || !list->json().is_array()) continue;
    for (const Json& used : list->json()) {
      if (used.is_string() && used.get_ref<const std::string&>() == name) return true;
    }
  }
  return false;
}

void require_extension(std::string_view name, Json& root) {
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    Json& list = array_of(root, key);
    if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
  }
}

}  // namespace fairway
