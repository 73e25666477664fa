// The scene graph of an untrusted glTF. Source: glTF 2.0 sections 3.2, 3.5. Nothing here recurses:
// the depth of the graph is the sender's choice.

#include "proto/formats/gltf_scene.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::size_t kNoParent = std::numeric_limits<std::size_t>::max();

std::size_t list_size(const JsonPlace& root, std::string_view key) {
  const auto list = root.find(key);
  return list && list->json().is_array() ? list->size() : 0;
}

Result<void> check_asset(const JsonPlace& root) {
  if (!root.json().is_object()) return root.error("a glTF is a JSON object.");
  const auto asset = root.object("asset");
  if (!asset) return asset.error();
  if (!*asset) return root.error("\"asset\" is missing, so this is no glTF 2.0 document.");
  const auto version = (*asset)->text("version");
  if (!version) return version.error();
  if (version->empty()) return (*asset)->error("\"version\" is missing.");
  const auto least = (*asset)->text("minVersion");
  if (!least) return least.error();
  if (!version->starts_with("2.") || (!least->empty() && *least != "2.0")) {
    return Error{ErrorCode::unsupported_format,
                 "This is not glTF 2.0; convert it to version 2.0 first.", "/asset"};
  }
  return {};
}

Result<void> check_numbers(const JsonPlace& node, std::string_view key, std::size_t size) {
  const auto list = node.array(key);
  if (!list) return list.error();
  if (!*list) return {};
  if ((*list)->size() != size) return (*list)->error(fmt::format("{} numbers are needed.", size));
  for (const Json& number : (*list)->json()) {
    const double value = number.is_number() ? number.get<double>() : NAN;
    if (!(std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()))) {
      return (*list)->error("these must be finite single-precision numbers.");
    }
  }
  return {};
}

Result<void> check_transform(const JsonPlace& node) {
  struct Member {
    const char* key;
    std::size_t size;
  };
  constexpr std::array<Member, 4> kMembers = {
      {{"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}}};
  for (const Member& member : kMembers) {
    if (auto done = check_numbers(node, member.key, member.size); !done) return done;
  }
  return {};
}

/// Records this node as the parent of its children.
Result<void> adopt_children(const JsonPlace& node, std::size_t self,
                            std::vector<std::size_t>& parents) {
  const auto children = node.array("children");
  if (!children) return children.error();
  for (std::size_t i = 0; *children && i < (*children)->size(); ++i) {
    const JsonPlace place = (**children)[i];
    const auto child = place.as_count();
    if (!child) return child.error();
    if (*child >= parents.size()) return place.error("there is no such node.");
    std::size_t& parent = parents[static_cast<std::size_t>(*child)];
    if (parent != kNoParent) return place.error("a node has one parent, this one has two.");
    parent = self;
  }
  return {};
}

/// Every node must reach a root within kMaxNodeDepth steps up.
Result<void> check_forest(const JsonPlace& nodes, const std::vector<std::size_t>& parents) {
  std::vector<int> depths(parents.size(), -1);
  for (std::size_t start = 0; start < parents.size(); ++start) {
    std::vector<std::size_t> path;
    std::size_t at = start;
    while (at != kNoParent && depths[at] < 0) {
      if (path.size() > static_cast<std::size_t>(kMaxNodeDepth)) {
        return nodes[start].error(
            fmt::format("its ancestors form a ring, or more than {} levels.", kMaxNodeDepth));
      }
      path.push_back(at);
      at = parents[at];
    }
    int depth = at == kNoParent ? 0 : depths[at] + 1;
    for (auto node = path.rbegin(); node != path.rend(); ++node) depths[*node] = depth++;
    if (depth > kMaxNodeDepth) {
      return nodes[start].error(fmt::format("nodes stand deeper than {} levels.", kMaxNodeDepth));
    }
  }
  return {};
}

Result<void> check_nodes(const JsonPlace& root) {
  const auto nodes = root.array("nodes");
  if (!nodes) return nodes.error();
  if (!*nodes) return {};
  std::vector<std::size_t> parents((*nodes)->size(), kNoParent);
  struct Reference {
    const char* key;
    std::size_t limit;
  };
  const std::array<Reference, 3> references = {{{"mesh", list_size(root, "meshes")},
                                                {"skin", list_size(root, "skins")},
                                                {"camera", list_size(root, "cameras")}}};
  for (std::size_t i = 0; i < (*nodes)->size(); ++i) {
    const JsonPlace node = (**nodes)[i];
    if (!node.json().is_object()) return node.error("this must be an object.");
    for (const Reference& reference : references) {
      if (const auto found = node.index(reference.key, reference.limit); !found) {
        return found.error();
      }
    }
    if (auto done = check_transform(node); !done) return done;
    if (auto done = adopt_children(node, i, parents); !done) return done;
  }
  return check_forest(**nodes, parents);
}

Result<void> check_scenes(const JsonPlace& root) {
  const auto scenes = root.array("scenes");
  if (!scenes) return scenes.error();
  const std::size_t node_count = list_size(root, "nodes");
  for (std::size_t i = 0; *scenes && i < (*scenes)->size(); ++i) {
    const JsonPlace scene = (**scenes)[i];
    const auto nodes = scene.array("nodes");
    if (!nodes) return nodes.error();
    for (std::size_t k = 0; *nodes && k < (*nodes)->size(); ++k) {
      const auto node = (**nodes)[k].as_count();
      if (!node) return node.error();
      if (*node >= node_count) return (**nodes)[k].error("there is no such node.");
    }
  }
  const auto scene = root.index("scene", list_size(root, "scenes"));
  if (!scene) return scene.error();
  return {};
}

}  // namespace

Result<void> check_scene(const JsonPlace& root) {
  if (auto done = check_asset(root); !done) return done;
  if (auto done = check_scenes(root); !done) return done;
  return check_nodes(root);
}

}  // namespace fairway
