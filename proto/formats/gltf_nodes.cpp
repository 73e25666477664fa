// Nodes of a checked glTF and what they do to lengths. Source: glTF 2.0 section 3.5. Nothing here
// recurses: the depth of the graph is the sender's choice.

#include "proto/formats/gltf_nodes.h"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace fairway {
namespace {

using Mat3 = Eigen::Matrix3d;

/// Relative, of squared lengths: more than digits that an exporter leaves out, less than anybody
/// means.
constexpr double kUniform = 1e-4;

const Json* member(const Json& json, const char* key) {
  if (!json.is_object()) return nullptr;
  const auto found = json.find(key);
  return found == json.end() ? nullptr : &*found;
}

/// An array that is there, else an empty one.
const Json& list(const Json& json, const char* key) {
  static const Json empty = Json::array();
  const Json* found = member(json, key);
  return found != nullptr && found->is_array() ? *found : empty;
}

std::optional<std::size_t> index_at(const Json& json, const char* key, std::size_t size) {
  const Json* found = member(json, key);
  if (found == nullptr || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  if (!(value >= 0.0 && value < static_cast<double>(size))) return std::nullopt;
  return static_cast<std::size_t>(value);
}

/// What a node does to directions and lengths.
Mat3 linear_part(const Json& node) {
  Mat3 out = Mat3::Identity();
  if (const Json* matrix = member(node, "matrix")) {
    for (Eigen::Index c = 0; c < 3; ++c) {
      for (Eigen::Index r = 0; r < 3; ++r) {
        out(r, c) = (*matrix)[static_cast<std::size_t>(4 * c + r)].get<double>();
      }
    }
    return out;
  }
  if (const Json* r = member(node, "rotation")) {
    const Eigen::Quaterniond turn((*r)[3].get<double>(), (*r)[0].get<double>(),
                                  (*r)[1].get<double>(), (*r)[2].get<double>());
    out = turn.normalized().toRotationMatrix();
  }
  if (const Json* s = member(node, "scale")) {
    out *= Vec3((*s)[0].get<double>(), (*s)[1].get<double>(), (*s)[2].get<double>()).asDiagonal();
  }
  return out;
}

/// The node N of a pointer "/nodes/N/scale".
std::optional<std::size_t> scaled_node(std::string_view pointer) {
  constexpr std::string_view kBefore = "/nodes/";
  constexpr std::string_view kBehind = "/scale";
  if (pointer.size() <= kBefore.size() + kBehind.size() || !pointer.starts_with(kBefore) ||
      !pointer.ends_with(kBehind)) {
    return std::nullopt;
  }
  pointer.remove_prefix(kBefore.size());
  pointer.remove_suffix(kBehind.size());
  std::size_t node = 0;
  const char* end = pointer.data() + pointer.size();
  const auto read = std::from_chars(pointer.data(), end, node);
  if (read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return node;
}

/// The node whose scale a channel of an animation moves.
std::optional<std::size_t> animated_node(const Json& channel, std::size_t nodes) {
  const Json* target = member(channel, "target");
  if (target == nullptr) return std::nullopt;
  const Json* path = member(*target, "path");
  if (path == nullptr || !path->is_string()) return std::nullopt;
  if (path->get_ref<const std::string&>() == "scale") return index_at(*target, "node", nodes);
  const Json* extensions = member(*target, "extensions");
  const Json* extension =
      extensions == nullptr ? nullptr : member(*extensions, "KHR_animation_pointer");
  const Json* pointer = extension == nullptr ? nullptr : member(*extension, "pointer");
  if (pointer == nullptr || !pointer->is_string()) return std::nullopt;
  const auto node = scaled_node(pointer->get_ref<const std::string&>());
  return node && *node < nodes ? node : std::nullopt;
}

bool scales_instances(const Json& node) {
  const Json* extensions = member(node, "extensions");
  const Json* instances =
      extensions == nullptr ? nullptr : member(*extensions, "EXT_mesh_gpu_instancing");
  const Json* attributes = instances == nullptr ? nullptr : member(*instances, "attributes");
  return attributes != nullptr && member(*attributes, "SCALE") != nullptr;
}

/// Where a node stands.
struct Placed {
  Mat3 linear = Mat3::Identity();
  bool animated = false;  ///< its scale or an ancestor's
};

std::vector<Placed> place_nodes(const Json& root) {
  const Json& nodes = list(root, "nodes");
  std::vector<Placed> out(nodes.size());
  for (const Json& animation : list(root, "animations")) {
    for (const Json& channel : list(animation, "channels")) {
      if (const auto node = animated_node(channel, nodes.size())) out[*node].animated = true;
    }
  }
  std::vector<bool> is_child(nodes.size(), false);
  for (const Json& node : nodes) {
    for (const Json& child : list(node, "children")) is_child[child.get<std::size_t>()] = true;
  }
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    out[i].linear = linear_part(nodes[i]);
    if (!is_child[i]) waiting.push_back(i);
  }
  while (!waiting.empty()) {
    const std::size_t parent = waiting.back();
    waiting.pop_back();
    for (const Json& json : list(nodes[parent], "children")) {
      const auto child = json.get<std::size_t>();
      out[child].linear = Mat3(out[parent].linear * out[child].linear);
      out[child].animated = out[child].animated || out[parent].animated;
      waiting.push_back(child);
    }
  }
  return out;
}

WorldScale scale_at(const Json& node, const Placed& placed) {
  if (node.contains("skin")) return {1.0, "it is skinned"};
  if (scales_instances(node)) return {1.0, "its instances are scaled"};
  if (placed.animated) return {1.0, "its scale is animated"};
  const Mat3 products = placed.linear.transpose() * placed.linear;
  const double squared = products.trace() / 3.0;
  const double scale = std::sqrt(squared);
  if (!(scale > 0.0) || !std::isfinite(squared)) return {1.0, "it is scaled to nothing"};
  const double off = (products - squared * Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kUniform * squared)) return {1.0, "its scale is not uniform"};
  return {scale, {}};
}

}  // namespace

SceneOutline outline_scene(const JsonPlace& root) {
  SceneOutline out;
  out.meshes = list(root.json(), "meshes").size();
  for (const Json& node : list(root.json(), "nodes")) {
    out.mesh_of_node.push_back(index_at(node, "mesh", out.meshes));
  }
  return out;
}

std::vector<WorldScale> world_scales(const JsonPlace& root, std::size_t meshes) {
  std::vector<WorldScale> out(meshes, WorldScale{1.0, "no node uses it"});
  std::vector<bool> used(meshes, false);
  const Json& nodes = list(root.json(), "nodes");
  const std::vector<Placed> placed = place_nodes(root.json());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto mesh = index_at(nodes[i], "mesh", meshes);
    if (!mesh) continue;
    const WorldScale here = scale_at(nodes[i], placed[i]);
    WorldScale& known = out[*mesh];
    if (!used[*mesh]) {
      known = here;
    } else if (known.why_none.empty() && !here.why_none.empty()) {
      known = here;
    } else if (known.why_none.empty() &&
               std::abs(here.value - known.value) > kUniform * known.value) {
      known = {1.0, "its nodes have different scales"};
    }
    used[*mesh] = true;
  }
  return out;
}

}  // namespace fairway
