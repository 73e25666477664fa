#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/result.h"
#include "proto/formats/byte_chain.h"
#include "proto/formats/bytes.h"
#include "proto/formats/gltf_extensions.h"
#include "proto/formats/gltf_side_files.h"
#include "proto/formats/json_fields.h"
#include "proto/formats/packed_values.h"
#include "proto/messages/format.h"

namespace fairway {

/// A buffer of a glTF that came as a file of its own.
struct SideBuffer {
  std::size_t index = 0;  ///< in "buffers"
  ByteSpan bytes;
};

/// The binary side of a glTF as it came.
struct GltfBinary {
  bool is_glb = false;
  std::optional<ByteSpan> bin;           ///< the BIN chunk
  std::optional<ByteSpan> first_buffer;  ///< the data of buffers[0], wherever it stands
  ByteSpan other_chunks;
  std::vector<SideBuffer> side_buffers;
  std::vector<SideImage> side_images;
};

/// What an appended view is for; the numbers of glTF.
enum class ViewTarget { vertices = 34962, indices = 34963 };

/// How the bytes of an appended view are stored.
enum class ViewCoding { plain, meshopt };

/// What an appended view is for and how it is stored.
struct ViewUse {
  ViewTarget target = ViewTarget::vertices;
  Bounds bounds = Bounds::left_out;
  ViewCoding coding = ViewCoding::plain;
};

/// A copy of a glTF that can be added to. Bytes that are there stay where they are; new ones go
/// behind them: to the end of the BIN chunk, or into a new buffer. Side files become part of it.
class GltfOutput {
 public:
  /// `binary` must outlive the output.
  GltfOutput(const Json& json, const GltfBinary& binary, Format format);

  Json& json() { return json_; }

  /// Appends the values with a view of their own and describes them in a new accessor, which this
  /// returns. What they borrow must live until finish().
  std::size_t add_accessor(PackedValues values, const ViewUse& use);

  /// The same for an accessor that is there: its name, extras and extensions stay.
  void fill_accessor(std::size_t index, PackedValues values, const ViewUse& use);

  /// An accessor without bytes, which describes values that stand in an extension's data; of
  /// `values` the bytes are not used. Without an index it is a new one. Returns its index.
  std::size_t label(std::optional<std::size_t> index, const PackedValues& values, Bounds bounds);

  /// Appends bytes that only an extension understands; returns their view.
  std::size_t add_stream(std::vector<std::byte> bytes);

  /// The file, which refers to `binary` and to what values borrow. Error: too_large.
  Result<ByteChain> finish();

 private:
  Json& add_view_of(std::size_t size);
  Json& add_bytes(std::vector<std::byte> bytes);
  std::size_t add_view(PackedValues& values, const ViewUse& use);
  bool add_compressed(const PackedValues& values, ViewTarget target);
  void close_fallback();
  void embed_image(const SideImage& image);
  void embed_side_files();
  void close_first_buffer();
  void close_new_buffer();

  Json json_;
  const GltfBinary& binary_;
  Format format_;
  bool extends_first_ = false;  ///< new bytes go behind buffers[0]
  std::size_t buffer_ = 0;      ///< that new views name
  std::size_t old_size_ = 0;    ///< bytes that were there
  ByteChain data_;              ///< of that buffer, old bytes and new ones
  const char* meshopt_extension_ = kMeshoptExtension;
  std::uint64_t fallback_ = 0;  ///< bytes that compressed views decode to
};

}  // namespace fairway
