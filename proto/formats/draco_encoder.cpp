// The one place that encodes with libdraco.

#include "proto/formats/draco_encoder.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <new>

#include <draco/compression/expert_encode.h>
#include <draco/metadata/metadata_encoder.h>
#include <fmt/format.h>

#include "proto/formats/draco_header.h"
#include "proto/formats/draco_library.h"

namespace fairway {
namespace {

constexpr int kFastest = 10;

draco::GeometryAttribute::Type type_of(DracoKind kind) {
  switch (kind) {
    case DracoKind::position:
      return draco::GeometryAttribute::POSITION;
    case DracoKind::normal:
      return draco::GeometryAttribute::NORMAL;
    case DracoKind::color:
      return draco::GeometryAttribute::COLOR;
    case DracoKind::tex_coord:
      return draco::GeometryAttribute::TEX_COORD;
    case DracoKind::generic:
      break;
  }
  return draco::GeometryAttribute::GENERIC;
}

draco::DataType data_type_of(ComponentType type) {
  switch (type) {
    case ComponentType::i8:
      return draco::DT_INT8;
    case ComponentType::u8:
      return draco::DT_UINT8;
    case ComponentType::i16:
      return draco::DT_INT16;
    case ComponentType::u16:
      return draco::DT_UINT16;
    case ComponentType::u32:
      return draco::DT_UINT32;
    case ComponentType::f32:
      break;
  }
  return draco::DT_FLOAT32;
}

/// An attribute with room for `points` elements, one per point.
std::unique_ptr<draco::PointAttribute> make_attribute(const DracoPart& part, ComponentType type,
                                                      bool normalized, Index points) {
  auto out = std::make_unique<draco::PointAttribute>();
  out->Init(type_of(part.kind), static_cast<std::int8_t>(part.components), data_type_of(type),
            normalized, points);
  return out;
}

/// Fills an attribute straight from where the values are.
struct AttributeMaker {
  const DracoPart& part;
  Index points;

  std::unique_ptr<draco::PointAttribute> operator()(std::span<const Vec3> vectors) const {
    auto out = make_attribute(part, ComponentType::f32, false, points);
    std::uint8_t* to = out->buffer()->data();
    for (const Vec3& vector : vectors) {
      const std::array<float, 3> stored = {static_cast<float>(vector.x()),
                                           static_cast<float>(vector.y()),
                                           static_cast<float>(vector.z())};
      std::memcpy(to, stored.data(), sizeof stored);
      to += sizeof stored;
    }
    return out;
  }

  std::unique_ptr<draco::PointAttribute> operator()(std::span<const float> values) const {
    auto out = make_attribute(part, ComponentType::f32, false, points);
    std::memcpy(out->buffer()->data(), values.data(), values.size_bytes());
    return out;
  }

  std::unique_ptr<draco::PointAttribute> operator()(const PackedValues& values) const {
    auto out = make_attribute(part, values.type, values.normalized, points);
    const std::size_t size = size_of(values.type) * static_cast<std::size_t>(values.components);
    for (std::size_t i = 0; i < values.count; ++i) {
      std::memcpy(out->buffer()->data() + i * size, values.bytes.data() + i * values.stride, size);
    }
    return out;
  }

  std::unique_ptr<draco::PointAttribute> operator()(const KeptDracoAttribute& kept) const {
    auto out = std::make_unique<draco::PointAttribute>();
    out->CopyFrom(*kept.mesh->decoded().mesh->attribute(kept.id));
    return out;
  }
};

/// The unique ids of the parts: those that are asked for, and new ones behind them.
std::vector<std::uint32_t> choose_ids(const DracoSource& source) {
  std::vector<std::optional<std::uint32_t>> wanted;
  std::uint32_t next = 0;
  for (const DracoPart& part : source.parts) {
    const auto* kept = std::get_if<KeptDracoAttribute>(&part.values);
    wanted.push_back(kept != nullptr ? kept->mesh->decoded().mesh->attribute(kept->id)->unique_id()
                                     : part.unique_id);
    if (wanted.back()) next = std::max(next, *wanted.back() + 1);
  }
  std::vector<std::uint32_t> out;
  out.reserve(wanted.size());
  for (const auto& id : wanted) out.push_back(id ? *id : next++);
  return out;
}

/// Of the whole mesh and of the attributes that stay; a new one may have the id of one that went.
void keep_metadata(const DracoSource& source, const std::vector<std::uint32_t>& ids,
                   draco::Mesh& mesh) {
  if (source.metadata == nullptr) return;
  const draco::GeometryMetadata* old = source.metadata->decoded().mesh->GetMetadata();
  if (old == nullptr) return;
  auto kept = std::make_unique<draco::GeometryMetadata>(*old);
  const auto stays = [&](std::uint32_t id) {
    const auto at = std::find(ids.begin(), ids.end(), id);
    return at != ids.end() && source.parts[static_cast<std::size_t>(at - ids.begin())].name.empty();
  };
  for (const auto& attribute : old->attribute_metadatas()) {
    const std::uint32_t id = attribute->att_unique_id();
    if (!stays(id)) kept->DeleteAttributeMetadataByUniqueId(static_cast<std::int32_t>(id));
  }
  mesh.AddMetadata(std::move(kept));
}

void add_parts(const DracoSource& source, const std::vector<std::uint32_t>& ids,
               draco::Mesh& mesh) {
  keep_metadata(source, ids, mesh);
  for (std::size_t i = 0; i < source.parts.size(); ++i) {
    const DracoPart& part = source.parts[i];
    const int id = mesh.AddAttribute(std::visit(AttributeMaker{part, source.points}, part.values));
    mesh.attribute(id)->set_unique_id(ids[i]);
    if (part.name.empty()) continue;
    auto metadata = std::make_unique<draco::AttributeMetadata>();
    metadata->AddEntryString("name", part.name);
    mesh.AddAttributeMetadata(id, std::move(metadata));
  }
}

void add_faces(const DracoSource& source, draco::Mesh& mesh) {
  mesh.set_num_points(source.points);
  mesh.SetNumFaces(source.triangles.size());
  for (std::uint32_t f = 0; f < source.triangles.size(); ++f) {
    const Triangle& t = source.triangles[f];
    mesh.SetFace(draco::FaceIndex(f), {draco::PointIndex(t[0] - source.first_point),
                                       draco::PointIndex(t[1] - source.first_point),
                                       draco::PointIndex(t[2] - source.first_point)});
  }
}

bool is_wide_integer(draco::DataType type) {
  return type == draco::DT_INT32 || type == draco::DT_UINT32 || type == draco::DT_INT64 ||
         type == draco::DT_UINT64;
}

/// True if libdraco's entropy coder must not see the values: it counts symbols in a table as long
/// as the largest one, so that 30 bits are gigabytes, whatever the size of the mesh.
bool has_wide_values(const draco::Mesh& mesh, const DracoSource& source) {
  constexpr int kMostBits = 20;
  for (std::size_t i = 0; i < source.parts.size(); ++i) {
    const DracoPart& part = source.parts[i];
    const bool wide_grid = part.grid && part.grid->bits > kMostBits;
    if (wide_grid || part.octahedral_bits > kMostBits) return true;
    if (is_wide_integer(mesh.attribute(static_cast<std::int32_t>(i))->data_type())) return true;
  }
  return false;
}

/// libdraco keeps options as text, and its own setters write six decimals: too few for the origin
/// and range of a small mesh. Both are set once more, in digits that read back as they are.
void set_grid(const QuantizationGrid& grid, std::int32_t id, draco::ExpertEncoder& encoder) {
  encoder.SetAttributeExplicitQuantization(id, grid.bits, static_cast<int>(grid.origin.size()),
                                           grid.origin.data(), grid.range);
  draco::Options options = *encoder.options().FindAttributeOptions(id);
  options.SetString("quantization_origin", fmt::format("{}", fmt::join(grid.origin, " ")));
  options.SetString("quantization_range", fmt::format("{}", grid.range));
  encoder.options().SetAttributeOptions(id, options);
}

/// How one attempt encodes.
struct Attempt {
  int level = 0;
  bool edgebreaker = false;
  bool compress_faces = true;
};

std::optional<DracoStream> encode(const draco::Mesh& mesh, const DracoSource& source,
                                  const Attempt& attempt) {
  draco::ExpertEncoder encoder(mesh);
  encoder.SetEncodingMethod(attempt.edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                                : draco::MESH_SEQUENTIAL_ENCODING);
  const bool wide = has_wide_values(mesh, source);
  // Above this level predictions are chosen by the same tables.
  const int level = wide ? std::min(attempt.level, 8) : attempt.level;
  encoder.SetSpeedOptions(kFastest - level, kFastest - level);
  encoder.options().SetGlobalBool("use_built_in_attribute_compression", !wide);
  encoder.SetTrackEncodedProperties(true);
  encoder.options().SetGlobalBool("compress_connectivity", attempt.compress_faces);
  for (std::size_t i = 0; i < source.parts.size(); ++i) {
    const DracoPart& part = source.parts[i];
    const auto id = static_cast<std::int32_t>(i);
    if (part.octahedral_bits > 0) encoder.SetAttributeQuantization(id, part.octahedral_bits);
    if (part.grid) set_grid(*part.grid, id, encoder);
    // Differences of integers that are 2³¹ apart are written, and refused by every decoder.
    if (is_wide_integer(mesh.attribute(id)->data_type()) &&
        !encoder.SetAttributePredictionScheme(id, draco::PREDICTION_NONE).ok()) {
      return std::nullopt;
    }
  }
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeToBuffer(&buffer).ok()) return std::nullopt;
  const auto* data = reinterpret_cast<const std::byte*>(buffer.data());
  DracoStream out;
  out.bytes.assign(data, data + buffer.size());
  out.points = encoder.num_encoded_points();
  out.triangles = encoder.num_encoded_faces();
  return out;
}

/// True if libdraco's decoder takes the faces: of a sequential mesh it wants three bytes for each
/// in what follows the counts, although compressed faces may need fewer.
bool has_bytes_for_faces(const DracoStream& stream, const draco::Mesh& mesh) {
  constexpr std::size_t kHeaderAndCounts = 11 + 5 + 5;
  std::size_t before = kHeaderAndCounts;
  if (mesh.GetMetadata() != nullptr) {
    draco::EncoderBuffer metadata;
    draco::MetadataEncoder().EncodeGeometryMetadata(&metadata, mesh.GetMetadata());
    before += metadata.size();
  }
  return stream.bytes.size() >= before + 3 * stream.triangles;
}

/// Edgebreaker takes all positions but the first for attributes with seams of their own, prepares
/// none for them, and reads it: libdraco 1.5.5 crashes.
bool has_more_positions(const draco::Mesh& mesh) {
  return mesh.NumNamedAttributes(draco::GeometryAttribute::POSITION) > 1;
}

/// The first attempt whose result readers take: Edgebreaker refuses some meshes, and compressed
/// faces may be so few bytes that they look like a bomb.
std::optional<DracoStream> encode_somehow(const draco::Mesh& mesh, const DracoSource& source,
                                          int level, DracoOrder order) {
  for (const Attempt& attempt :
       {Attempt{level, true, true}, Attempt{level, false, true}, Attempt{level, false, false}}) {
    if (attempt.edgebreaker && (order == DracoOrder::kept || has_more_positions(mesh))) continue;
    if (!attempt.edgebreaker && !draco_keeps_points(source.points, source.triangles.size())) {
      continue;
    }
    auto out = encode(mesh, source, attempt);
    if (!out || out->triangles == 0 || !check_draco_header(out->bytes)) continue;
    if (attempt.edgebreaker || has_bytes_for_faces(*out, mesh)) return out;
  }
  return std::nullopt;
}

Error refusal(const DracoSource& source) {
  if (draco_keeps_points(source.points, source.triangles.size())) {
    return {ErrorCode::unsupported_feature,
            "Draco cannot store the values of this mesh; ask for another format, or for "
            "\"compression\": \"none\"."};
  }
  return {ErrorCode::unsupported_feature,
          fmt::format("Draco holds at most three points per triangle, and the mesh has {} vertices "
                      "for {} triangles; remove the vertices that no triangle uses, leave them out "
                      "with \"keep_order\": false, or ask for another format.",
                      source.points, source.triangles.size())};
}

}  // namespace

bool draco_keeps_points(std::uint64_t points, std::uint64_t triangles) {
  return points <= 3 * triangles;
}

Result<DracoStream> encode_draco(const DracoSource& source, int level, DracoOrder order) {
  try {
    draco::Mesh mesh;
    const std::vector<std::uint32_t> ids = choose_ids(source);
    add_faces(source, mesh);
    add_parts(source, ids, mesh);
    auto out = encode_somehow(mesh, source, level, order);
    if (!out) return refusal(source);
    out->unique_ids = ids;
    return *std::move(out);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::too_large, "Writing Draco needs more memory than a job may have."};
  } catch (const std::exception&) {
    return Error{ErrorCode::internal, "The Draco library failed on this mesh."};
  }
}

}  // namespace fairway
