// The one place that decodes with libdraco. Its answers are checked before they are used: ok() can
// hold face indices beyond the points, attributes that map nowhere, and any number of bytes asked
// for.

#include "proto/formats/draco_decoder.h"

#include <algorithm>
#include <new>
#include <stdexcept>

#include <draco/compression/decode.h>

#include "proto/formats/draco_header.h"
#include "proto/formats/draco_library.h"

namespace fairway {
namespace {

Error broken(std::string_view what) {
  return {ErrorCode::invalid_mesh, "The Draco mesh " + std::string(what) + "; encode it again."};
}

Error out_of_memory() {
  return {ErrorCode::too_large,
          "Decoding the Draco data needs more memory than a job may have; send a smaller mesh."};
}

DracoKind kind_of(draco::GeometryAttribute::Type type) {
  switch (type) {
    case draco::GeometryAttribute::POSITION:
      return DracoKind::position;
    case draco::GeometryAttribute::NORMAL:
      return DracoKind::normal;
    case draco::GeometryAttribute::COLOR:
      return DracoKind::color;
    case draco::GeometryAttribute::TEX_COORD:
      return DracoKind::tex_coord;
    default:
      return DracoKind::generic;
  }
}

std::optional<ComponentType> component_type_of(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return ComponentType::i8;
    case draco::DT_UINT8:
      return ComponentType::u8;
    case draco::DT_INT16:
      return ComponentType::i16;
    case draco::DT_UINT16:
      return ComponentType::u16;
    case draco::DT_UINT32:
      return ComponentType::u32;
    case draco::DT_FLOAT32:
      return ComponentType::f32;
    default:
      return std::nullopt;
  }
}

double read_value(draco::DataType type, const std::byte* data) {
  switch (type) {
    case draco::DT_INT32:
      return load<std::int32_t>(data);
    case draco::DT_INT64:
      return static_cast<double>(load<std::int64_t>(data));
    case draco::DT_UINT64:
      return static_cast<double>(load<std::uint64_t>(data));
    case draco::DT_FLOAT64:
      return load<double>(data);
    case draco::DT_BOOL:
      return load<std::uint8_t>(data) != 0 ? 1.0 : 0.0;
    default:
      break;
  }
  const auto known = component_type_of(type);
  return known ? read_component(*known, data) : 0.0;
}

Result<std::unique_ptr<draco::Mesh>> decode_mesh(ByteSpan bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) {
    return Error{ErrorCode::malformed_input,
                 "The Draco data does not decode; send the whole file, or encode it again."};
  }
  std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
  if (!mesh) return broken("is empty");
  return mesh;
}

Result<std::vector<Triangle>> checked_triangles(const draco::Mesh& mesh) {
  std::vector<Triangle> out;
  out.reserve(mesh.num_faces());
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
    const draco::Mesh::Face& face = mesh.face(f);
    const Triangle triangle = {face[0].value(), face[1].value(), face[2].value()};
    if (*std::max_element(triangle.begin(), triangle.end()) >= mesh.num_points()) {
      return broken("has a face with a point that does not exist");
    }
    out.push_back(triangle);
  }
  return out;
}

std::string name_of(const draco::Mesh& mesh, int attribute) {
  std::string name;
  const draco::AttributeMetadata* metadata = mesh.GetAttributeMetadataByAttributeId(attribute);
  if (metadata == nullptr || !metadata->GetEntryString("name", &name)) return {};
  return name;
}

std::vector<DracoAttribute> list_attributes(const draco::Mesh& mesh) {
  std::vector<DracoAttribute> out;
  for (int i = 0; i < mesh.num_attributes(); ++i) {
    const draco::PointAttribute* from = mesh.attribute(i);
    if (from == nullptr) continue;
    out.push_back({i, from->unique_id(), kind_of(from->attribute_type()),
                   component_type_of(from->data_type()), from->normalized(), from->num_components(),
                   name_of(mesh, i)});
  }
  return out;
}

/// True if the value of every point lies in the attribute's own bytes.
bool maps_inside(const draco::PointAttribute& attribute, std::uint32_t points) {
  const draco::DataBuffer* buffer = attribute.buffer();
  const auto size = static_cast<std::uint64_t>(draco::DataTypeLength(attribute.data_type())) *
                    static_cast<std::uint64_t>(attribute.num_components());
  if (buffer == nullptr || size == 0 || attribute.byte_stride() < 0 ||
      attribute.byte_offset() < 0) {
    return false;
  }
  if (!attribute.is_mapping_identity() && attribute.indices_map_size() < points) return false;
  std::uint32_t last = 0;
  for (draco::PointIndex p(0); p < points; ++p) {
    last = std::max(last, attribute.mapped_index(p).value());
  }
  const auto end =
      strided_end(static_cast<std::uint64_t>(attribute.byte_offset()), std::uint64_t{last} + 1,
                  static_cast<std::uint64_t>(attribute.byte_stride()), size);
  return end && *end <= buffer->data_size();
}

std::vector<double> copy_values(const draco::PointAttribute& attribute, std::uint32_t points) {
  const draco::DataType type = attribute.data_type();
  const auto size = static_cast<std::size_t>(draco::DataTypeLength(type));
  const auto components = static_cast<std::size_t>(attribute.num_components());
  std::vector<double> out;
  out.reserve(points * components);
  for (draco::PointIndex p(0); p < points; ++p) {
    const auto* data = reinterpret_cast<const std::byte*>(attribute.GetAddressOfMappedIndex(p));
    for (std::size_t c = 0; c < components; ++c) out.push_back(read_value(type, data + c * size));
  }
  return out;
}

}  // namespace

DracoMesh::DracoMesh(std::unique_ptr<Decoded> decoded) : decoded_(std::move(decoded)) {}
DracoMesh::DracoMesh(DracoMesh&&) noexcept = default;
DracoMesh& DracoMesh::operator=(DracoMesh&&) noexcept = default;
DracoMesh::~DracoMesh() = default;

Result<DracoMesh> DracoMesh::decode(ByteSpan bytes) {
  if (const auto checked = check_draco_header(bytes); !checked) return checked.error();
  try {
    auto mesh = decode_mesh(bytes);
    if (!mesh) return mesh.error();
    auto triangles = checked_triangles(**mesh);
    if (!triangles) return triangles.error();
    DracoMesh out(std::make_unique<Decoded>());
    out.point_count_ = (*mesh)->num_points();
    out.triangles_ = *std::move(triangles);
    out.attributes_ = list_attributes(**mesh);
    out.decoded_->mesh = *std::move(mesh);
    return out;
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  } catch (const std::length_error&) {
    return out_of_memory();
  } catch (const std::exception&) {
    return broken("does not decode");
  }
}

const DracoAttribute* DracoMesh::find(DracoKind kind) const {
  const auto it = std::find_if(attributes_.begin(), attributes_.end(),
                               [kind](const DracoAttribute& a) { return a.kind == kind; });
  return it == attributes_.end() ? nullptr : &*it;
}

const DracoAttribute* DracoMesh::find_unique(std::uint64_t unique_id) const {
  const auto it =
      std::find_if(attributes_.begin(), attributes_.end(),
                   [unique_id](const DracoAttribute& a) { return a.unique_id == unique_id; });
  return it == attributes_.end() ? nullptr : &*it;
}

Result<void> DracoMesh::check_values(const DracoAttribute& attribute) const {
  if (maps_inside(*decoded_->mesh->attribute(attribute.id), point_count_)) return {};
  return broken("has points without values");
}

Result<std::vector<double>> DracoMesh::values(const DracoAttribute& attribute) const {
  if (const auto done = check_values(attribute); !done) return done.error();
  try {
    return copy_values(*decoded_->mesh->attribute(attribute.id), point_count_);
  } catch (const std::bad_alloc&) {
    return out_of_memory();
  }
}

}  // namespace fairway
