#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <vector>

#include "core/mesh.h"
#include "core/result.h"
#include "proto/formats/bytes.h"
#include "proto/formats/component_type.h"
#include "proto/formats/gltf_side_files.h"
#include "proto/formats/json_fields.h"
#include "proto/formats/meshopt_decoder.h"

namespace fairway {

/// A buffer of a glTF; without data where it is only a placeholder for compressed views.
struct GltfBuffer {
  std::uint64_t length = 0;
  std::optional<ByteSpan> data;  ///< `length` bytes
  bool is_side_file = false;
};

/// The meshopt stream that holds the elements of a view; it lies inside its buffer.
struct GltfCompression {
  std::size_t buffer = 0;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::optional<MeshoptLayout> layout;  ///< nothing where mode or filter is not known
};

/// A buffer view; `offset` + `length` lies inside its buffer.
struct GltfView {
  std::size_t buffer = 0;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::optional<std::uint64_t> stride;
  std::optional<GltfCompression> compression = {};
  std::optional<ByteSpan> decoded = {};  ///< `length` bytes, where they had to be decoded
};

/// The replaced elements of a sparse accessor; both parts lie inside their views.
struct GltfSparse {
  std::uint64_t count = 0;
  std::size_t indices_view = 0;
  std::uint64_t indices_offset = 0;
  ComponentType indices_type = ComponentType::u32;
  std::size_t values_view = 0;
  std::uint64_t values_offset = 0;
};

/// An accessor; its elements lie inside its view.
struct GltfAccessor {
  std::optional<std::size_t> view;
  std::uint64_t offset = 0;
  ComponentType type = ComponentType::f32;
  bool normalized = false;
  bool matrix = false;
  int components = 1;
  std::size_t element_size = 4;
  std::uint64_t count = 0;
  std::optional<GltfSparse> sparse;

  bool is_scalar() const { return components == 1; }
  bool is_vector(int size) const { return components == size && !matrix; }
};

/// Everything binary of a glTF, checked: no view leaves its buffer and no accessor its view.
struct GltfTables {
  std::vector<GltfBuffer> buffers;
  std::vector<GltfView> views;
  std::vector<GltfAccessor> accessors;
  std::list<std::vector<std::byte>> owned;  ///< what data URIs and compressed views held
  /// Most elements that anything may have without bytes of its own for each of them.
  std::uint64_t element_limit = 0;
  std::uint64_t decoded_bytes = 0;  ///< of compressed views
};

/// Reads the buffers (data URIs, `side_files`, `bin` for a first buffer without URI), views and
/// accessors of a document. `input_size` is the size of the whole file, to which what is read of
/// side files is added. A buffer that stands only for compressed views needs no data.
Result<GltfTables> read_tables(const JsonPlace& root, std::optional<ByteSpan> bin,
                               std::uint64_t input_size, SideReader& side_files);

/// The same tables over the same bytes, which `tables` must keep: to decode more views for a while.
GltfTables without_owned(const GltfTables& tables);

/// The bytes of a view. Error: unsupported_feature where its buffer has none.
Result<ByteSpan> view_bytes(const GltfTables& tables, std::size_t view);

}  // namespace fairway
