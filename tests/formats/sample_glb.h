#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/mesh.h"
#include "proto/formats/document.h"
#include "proto/messages/json.h"

namespace fairway::test {

using Bytes = std::vector<std::byte>;

/// A GLB taken apart by the tests' own code, and put together by it: no code of fairway's formats.
struct SampleGlb {
  Json json;
  Bytes bin;

  /// Adds bytes at the next multiple of four and a view of them.
  std::size_t add_view(std::span<const std::byte> bytes, std::size_t stride = 0);
  /// Adds an accessor over a view.
  std::size_t add_accessor(std::size_t view, unsigned component_type, std::string type,
                           std::size_t count, std::size_t offset = 0);
  std::size_t add_vec3(const std::vector<std::array<float, 3>>& values);
  std::size_t add_indices(const std::vector<std::uint32_t>& indices);
  std::size_t add_mesh(Json primitives);

  Bytes glb() const;
  /// The same document as self-contained .gltf.
  Bytes gltf() const;
};

template <class T>
Bytes bytes_of(const std::vector<T>& values) {
  const auto* data = reinterpret_cast<const std::byte*>(values.data());
  return {data, data + values.size() * sizeof(T)};
}

/// {"asset", "scene", one node of mesh 0}, nothing else.
SampleGlb empty_sample();

/// Corners and triangles of a cube of edge 2 about the origin.
std::vector<std::array<float, 3>> cube_corners();
std::vector<std::uint32_t> cube_indices();

/// A cube with u32 indices, one triangle primitive, one mesh, one node.
SampleGlb cube_sample();

/// Takes a GLB apart.
SampleGlb parse_sample(std::span<const std::byte> glb);

/// Decoded base64 of a data URI, by the tests' own code.
Bytes data_uri_bytes(const std::string& uri);

Bytes text_bytes(const std::string& text);

/// One result per surface: every position moved by the same vector, or left alone.
std::vector<SurfaceResult> shifted(const Document& document, const Vec3& by);
std::vector<SurfaceResult> unmoved(const Document& document);
/// Adds an attribute with the values 0, 1, 2 … to every result.
void add_ramp(const Document& document, const std::string& name, int components,
              std::vector<SurfaceResult>& results);

/// A document together with the bytes it refers to.
class Decoded {
 public:
  Decoded(Bytes bytes, Format format);
  const Document& operator*() const { return *document_; }
  const Document* operator->() const { return document_.get(); }

 private:
  Bytes bytes_;
  std::unique_ptr<Document> document_;
};

/// decode(), or the failure of the test.
Decoded decoded(Bytes bytes, Format format = Format::glb);

/// The floats of a float accessor over a plain view of the BIN chunk.
std::vector<float> floats_of(const SampleGlb& sample, std::size_t accessor);

}  // namespace fairway::test
