// What a bare Draco file holds beside positions and normals. Its encoder takes PLY and OBJ, so that
// colours are sRGB and v counts from the lower edge; libdraco's own glTF writer turns v around,
// too.

#include "proto/formats/draco_extras.h"

#include <algorithm>

#include <fmt/format.h>

namespace fairway {
namespace {

/// Longest name of an attribute that is taken over into a glTF.
constexpr std::size_t kLongestName = 64;

/// What stands for 1.
double full_scale(const DracoAttribute& attribute) {
  if (attribute.type == ComponentType::u8) return 255.0;
  if (attribute.type == ComponentType::u16) return 65535.0;
  return 1.0;
}

Result<std::vector<double>> scaled_values(const DracoMesh& mesh, const DracoAttribute& attribute) {
  auto out = mesh.values(attribute);
  if (!out) return out;
  const double scale = full_scale(attribute);
  for (double& value : *out) value /= scale;
  return out;
}

/// Bytes and shorts keep their type; of the larger ones glTF knows only floats in a vertex.
Packing packing_of(const DracoAttribute& attribute) {
  const bool fits = attribute.type == ComponentType::u8 || attribute.type == ComponentType::u16 ||
                    attribute.type == ComponentType::i8 || attribute.type == ComponentType::i16;
  return {fits ? *attribute.type : ComponentType::f32, fits && attribute.normalized,
          attribute.components};
}

/// A name that an application may give to an attribute in glTF.
bool is_custom_name(std::string_view name) {
  return name.starts_with('_') && name.size() <= kLongestName &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return c == '_' || (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                  (c >= 'a' && c <= 'z');
         });
}

}  // namespace

bool holds_colors(const DracoAttribute& attribute) {
  const bool has_type = attribute.type == ComponentType::u8 ||
                        attribute.type == ComponentType::u16 ||
                        attribute.type == ComponentType::f32;
  return attribute.kind == DracoKind::color && has_type &&
         (attribute.components == 3 || attribute.components == 4);
}

bool holds_texture_coordinates(const DracoAttribute& attribute) {
  return attribute.kind == DracoKind::tex_coord && attribute.components == 2;
}

Result<ColorValues> draco_colors(const DracoMesh& mesh, const DracoAttribute& attribute) {
  const auto values = scaled_values(mesh, attribute);
  if (!values) return values.error();
  return make_colors(*values, attribute.components);
}

Result<std::vector<float>> draco_texture_coordinates(const DracoMesh& mesh,
                                                     const DracoAttribute& attribute) {
  const auto values = scaled_values(mesh, attribute);
  if (!values) return values.error();
  return make_texture_coordinates(*values);
}

std::string GltfNames::name(const DracoAttribute& attribute) {
  if (holds_texture_coordinates(attribute)) {
    return fmt::format("TEXCOORD_{}", texture_coordinates_++);
  }
  if (holds_colors(attribute)) {
    return fmt::format("COLOR_{}", colors_++);
  }
  const bool fits = attribute.components >= 1 && attribute.components <= 4;
  if (attribute.kind != DracoKind::generic || !fits || !is_custom_name(attribute.name)) return {};
  return names_.insert(attribute.name).second ? attribute.name : std::string();
}

Result<PackedValues> pack_for_gltf(const DracoMesh& mesh, const DracoAttribute& attribute) {
  if (holds_colors(attribute)) {
    const auto colors = draco_colors(mesh, attribute);
    if (!colors) return colors.error();
    return pack_linear_colors(*colors);
  }
  if (holds_texture_coordinates(attribute)) {
    const auto values = draco_texture_coordinates(mesh, attribute);
    if (!values) return values.error();
    return pack_texture_coordinates_from_top(*values);
  }
  const auto values = mesh.values(attribute);
  if (!values) return values.error();
  return pack_values(*values, packing_of(attribute));
}

}  // namespace fairway
