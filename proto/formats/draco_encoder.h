#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "proto/formats/draco_decoder.h"
#include "proto/formats/packed_values.h"
#include "proto/formats/quantization.h"

namespace fairway {

/// An attribute that goes from a decoded mesh of the same points to a new one as it is: with its
/// type, unique id and metadata.
struct KeptDracoAttribute {
  const DracoMesh* mesh = nullptr;
  int id = 0;
};

/// One attribute to encode. What `values` refers to must outlive the encoding.
struct DracoPart {
  DracoKind kind = DracoKind::generic;
  std::string name;  ///< becomes the metadata "name" of a generic attribute
  int components = 3;
  std::variant<std::span<const Vec3>, std::span<const float>, PackedValues, KeptDracoAttribute>
      values;
  std::optional<QuantizationGrid> grid = {};    ///< nothing: values stay as they are
  int octahedral_bits = 0;                      ///< of normals, instead of a grid; 0: as they are
  std::optional<std::uint32_t> unique_id = {};  ///< nothing: the next free one
};

/// A mesh to encode.
struct DracoSource {
  std::span<const Triangle> triangles;
  Index first_point = 0;  ///< what `triangles` count from
  Index points = 0;
  std::vector<DracoPart> parts;
  const DracoMesh* metadata = nullptr;  ///< whose metadata is kept
};

enum class DracoOrder { kept, free };

/// An encoded mesh.
struct DracoStream {
  std::vector<std::byte> bytes;
  std::vector<std::uint32_t> unique_ids;  ///< one per part
  std::uint64_t points = 0;               ///< that a reader gets
  std::uint64_t triangles = 0;
};

/// Whether a mesh can keep its points in their order: libdraco's decoder takes a sequential mesh
/// for broken that has more than three points per triangle. Edgebreaker leaves out unused ones.
bool draco_keeps_points(std::uint64_t points, std::uint64_t triangles);

/// Encodes with Draco 2.2: sequentially, so that points and triangles keep their order, or by
/// Edgebreaker where the order is free and the mesh lets it. `level` is 0 (fast) to 10 (small).
/// What comes out passes check_draco_header(). Errors: unsupported_feature (values that Draco
/// cannot store, too many unused points), too_large.
Result<DracoStream> encode_draco(const DracoSource& source, int level, DracoOrder order);

}  // namespace fairway
