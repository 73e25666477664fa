#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "proto/formats/bytes.h"
#include "proto/formats/component_type.h"

namespace fairway {

/// What a Draco attribute is for.
enum class DracoKind { position, normal, color, tex_coord, generic };

/// One attribute of a decoded mesh.
struct DracoAttribute {
  int id = 0;                   ///< place in this mesh
  std::uint32_t unique_id = 0;  ///< the name it has in KHR_draco_mesh_compression
  DracoKind kind = DracoKind::generic;
  std::optional<ComponentType> type;  ///< nothing for types glTF does not have
  bool normalized = false;
  int components = 0;
  std::string name;  ///< its metadata entry "name", "" if it has none
};

/// A decoded Draco mesh whose face indices have been checked. Its vertices are Draco's points.
class DracoMesh {
 public:
  /// Decodes untrusted bytes. Errors: those of check_draco_header(), malformed_input (libdraco
  /// refuses), invalid_mesh (it accepts what is broken), too_large (it asks for too much memory).
  static Result<DracoMesh> decode(ByteSpan bytes);

  DracoMesh(DracoMesh&&) noexcept;
  DracoMesh& operator=(DracoMesh&&) noexcept;
  ~DracoMesh();

  Index point_count() const { return point_count_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<DracoAttribute>& attributes() const { return attributes_; }

  /// The first attribute of a kind, or the one of a unique id.
  const DracoAttribute* find(DracoKind kind) const;
  const DracoAttribute* find_unique(std::uint64_t unique_id) const;

  /// Whether every point has a value of the attribute. Error: invalid_mesh.
  Result<void> check_values(const DracoAttribute& attribute) const;

  /// Components of every point as they are stored. Errors: invalid_mesh, too_large.
  Result<std::vector<double>> values(const DracoAttribute& attribute) const;

  /// Hands the triangles over, for a reader that keeps them elsewhere.
  std::vector<Triangle> take_triangles() { return std::move(triangles_); }

  /// The library's mesh, for the encoder; see draco_library.h.
  struct Decoded;
  const Decoded& decoded() const { return *decoded_; }

 private:
  explicit DracoMesh(std::unique_ptr<Decoded> decoded);

  std::unique_ptr<Decoded> decoded_;
  Index point_count_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<DracoAttribute> attributes_;
};

}  // namespace fairway
