// Draco-compressed primitives of a glTF. Source: KHR_draco_mesh_compression.

#include "proto/formats/gltf_draco.h"

#include "proto/formats/gltf_extensions.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxDracoAttributes = 256;

/// Whether the values of an attribute can be those of the accessor that labels it. Asked when the
/// file is read, so that nothing is left to be found out after the work is done.
Result<void> check_label(const DracoMesh& mesh, const DracoAttribute& attribute,
                         const GltfAccessor& accessor) {
  if (attribute.components != accessor.components || accessor.matrix) {
    return Error{ErrorCode::invalid_mesh,
                 "An attribute of the Draco data has another number of components than its "
                 "accessor states."};
  }
  return mesh.check_values(attribute);
}

/// Stored values of Draco's type become stored values of the accessor's type.
void convert(const DracoAttribute& from, const GltfAccessor& to, std::vector<double>& values) {
  if (from.type == to.type) return;
  const bool from_integer = from.type && from.type != ComponentType::f32;
  // Integers keep their meaning; floats become the integers that the accessor decodes to them.
  const bool scaled = from.normalized || (to.normalized && !from_integer);
  for (double& value : values) {
    const double meant = from.type ? decode_component({*from.type, from.normalized}, value) : value;
    value = encode_component({to.type, scaled}, meant);
  }
}

Result<std::vector<double>> stored_values(const DracoMesh& mesh, const DracoAttribute& attribute,
                                          const GltfAccessor& accessor) {
  auto values = mesh.values(attribute);
  if (values) convert(attribute, accessor, *values);
  return values;
}

}  // namespace

Result<std::optional<DracoUse>> read_draco_use(const JsonPlace& primitive,
                                               const GltfTables& tables) {
  const auto extensions = primitive.object("extensions");
  if (!extensions) return extensions.error();
  if (!*extensions) return std::optional<DracoUse>();
  const auto extension = (*extensions)->object(kDracoExtension);
  if (!extension) return extension.error();
  if (!*extension) return std::optional<DracoUse>();
  const auto view = (*extension)->required_index("bufferView", tables.views.size());
  if (!view) return view.error();
  const auto attributes = (*extension)->object("attributes");
  if (!attributes) return attributes.error();
  DracoUse use;
  use.view = *view;
  if (*attributes) {
    if ((*attributes)->size() > kMaxDracoAttributes) {
      return (*attributes)
          ->error("more attributes are stated than Draco data has; leave some out.");
    }
    for (const auto& item : (*attributes)->json().items()) {
      const auto id = (*attributes)->required_count(item.key());
      if (!id) return id.error();
      use.ids.emplace(item.key(), *id);
    }
  }
  if (!use.ids.contains("POSITION")) {
    return (*extension)->error("the compressed attributes have no POSITION.");
  }
  return std::optional<DracoUse>(std::move(use));
}

Result<void> decode_draco_use(const JsonPlace& primitive, const DracoUse& use,
                              const AttributeAccessors& accessors, const GltfTables& tables,
                              DracoMeshes& meshes) {
  auto found = meshes.find(use.view);
  if (found == meshes.end()) {
    const auto bytes = view_bytes(tables, use.view);
    if (!bytes) return bytes.error();
    auto mesh = DracoMesh::decode(*bytes);
    if (!mesh && mesh.error().code == ErrorCode::too_large) return mesh.error();
    if (!mesh) return primitive.error("its Draco data is broken. " + mesh.error().message);
    found = meshes.emplace(use.view, *std::move(mesh)).first;
  }
  const DracoMesh& mesh = found->second;
  for (const auto& [name, id] : use.ids) {
    const DracoAttribute* attribute = mesh.find_unique(id);
    if (attribute == nullptr) {
      return primitive.error("its Draco data has no attribute with the id of " +
                             (name.size() <= 64 ? name : name.substr(0, 64)) + ".");
    }
    const auto label = accessors.find(name);
    if (label == accessors.end()) continue;
    if (auto done = check_label(mesh, *attribute, tables.accessors[label->second]); !done) {
      return primitive.error(done.error().message);
    }
  }
  return {};
}

Result<std::vector<double>> draco_values(const DracoMesh& mesh, const DracoAttribute& attribute,
                                         const GltfAccessor& accessor) {
  auto values = stored_values(mesh, attribute, accessor);
  if (!values) return values;
  for (double& value : *values) {
    value = decode_component({accessor.type, accessor.normalized}, value);
  }
  return values;
}

Result<PackedValues> pack_draco(const DracoMesh& mesh, const DracoAttribute& attribute,
                                const GltfAccessor& accessor) {
  const auto values = stored_values(mesh, attribute, accessor);
  if (!values) return values.error();
  return pack_values(*values, {accessor.type, accessor.normalized, accessor.components});
}

}  // namespace fairway
