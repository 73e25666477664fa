// Who names what in the DOM of a glTF.

#include "proto/formats/gltf_references.h"

#include "proto/formats/gltf_extensions.h"

namespace fairway {
namespace {

void count_references(const Json& json, std::vector<std::size_t>& counts) {
  // An index may be written as 3.0.
  if (!json.is_number()) return;
  const auto index = json.get<double>();
  if (index >= 0.0 && index < static_cast<double>(counts.size())) {
    ++counts[static_cast<std::size_t>(index)];
  }
}

void count_members(const Json& object, std::vector<std::size_t>& counts) {
  if (!object.is_object()) return;
  for (const auto& item : object.items()) count_references(item.value(), counts);
}

const Json& member(const Json& object, const char* key) {
  static const Json none;
  if (!object.is_object()) return none;
  const auto it = object.find(key);
  return it == object.end() ? none : *it;
}

bool any_primitive_uses_draco(const Json& root) {
  for (const Json& mesh : member(root, "meshes")) {
    for (const Json& primitive : member(mesh, "primitives")) {
      if (member(primitive, "extensions").contains(kDracoExtension)) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::size_t> accessor_references(const Json& root, std::size_t accessors) {
  std::vector<std::size_t> counts(accessors, 0);
  for (const Json& mesh : member(root, "meshes")) {
    for (const Json& primitive : member(mesh, "primitives")) {
      count_members(member(primitive, "attributes"), counts);
      count_references(member(primitive, "indices"), counts);
      for (const Json& target : member(primitive, "targets")) count_members(target, counts);
    }
  }
  for (const Json& skin : member(root, "skins")) {
    count_references(member(skin, "inverseBindMatrices"), counts);
  }
  for (const Json& animation : member(root, "animations")) {
    for (const Json& sampler : member(animation, "samplers")) {
      count_references(member(sampler, "input"), counts);
      count_references(member(sampler, "output"), counts);
    }
  }
  return counts;
}

void forget_unused_draco(Json& root) {
  if (any_primitive_uses_draco(root)) return;
  for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
    const auto list = root.find(key);
    if (list == root.end()) continue;
    for (std::size_t i = list->size(); i-- > 0;) {
      if ((*list)[i] == kDracoExtension) list->erase(i);
    }
    if (list->empty()) root.erase(key);
  }
}

}  // namespace fairway
