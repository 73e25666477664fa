// `fairway sample` and `fairway compare`: generated meshes, and how far one is from another.

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#include <fmt/format.h>

#include "core/shapes.h"
#include "proto/formats/document.h"
#include "proto/formats/fresh_mesh.h"
#include "server/fairway/commands.h"
#include "server/fairway/input_file.h"
#include "server/fairway/side_folder.h"

namespace fairway {
namespace {

struct Shape {
  std::string_view name;
  Index default_size;
  Index largest_size;
  IndexedMesh (*make)(Index size);
};

constexpr std::array kShapes = {
    Shape{"ring", 7, 90, [](Index n) { return ring(220 * n / 7, n); }},
    Shape{"sphere", 5, 9, [](Index n) { return sphere(n, 1.0); }},
    Shape{"octahedron", 40, 800, [](Index n) { return octahedron(n); }},
    Shape{"torus", 50, 1000, [](Index n) { return torus(2 * n, n, 1.0, 0.4); }},
    Shape{"sheet", 60, 1500, [](Index n) { return sheet(n); }},
};

Result<IndexedMesh> make_shape(const SampleCommand& command) {
  for (const Shape& shape : kShapes) {
    if (shape.name != command.shape) continue;
    const Index size = command.size == 0 ? shape.default_size : command.size;
    if (size > shape.largest_size) {
      return Error{ErrorCode::usage,
                   fmt::format("A {} has at most --size {}.", shape.name, shape.largest_size)};
    }
    return shape.make(size < 2 ? 2 : size);
  }
  return Error{ErrorCode::usage, "Shapes are ring, sphere, octahedron, torus and sheet."};
}

Result<void> write_mesh(const std::string& path, const IndexedMesh& mesh) {
  const Result<Format> format = format_of_output(path);
  if (!format) return format.error();
  Surface surface;
  surface.mesh = mesh;
  const Result<Encoded> file = write_fresh_mesh(surface, {}, *format, {});
  if (!file) return file.error();
  return write_file(path, file->bytes);
}

/// All surfaces of a file as one triangle list.
Result<IndexedMesh> read_mesh(const std::string& path) {
  const Result<InputFile> file = InputFile::open(path);
  if (!file) return file.error();
  const auto head = file->bytes().first(std::min(file->bytes().size(), kMagicBytes));
  const Result<Format> format = recognise_format(head, "", path);
  if (!format) return format.error();
  SideFolder files(path);
  const Result<std::unique_ptr<Document>> document =
      decode(file->bytes(), *format, files.provider());
  if (!document) return document.error();
  IndexedMesh mesh;
  for (const Surface& surface : (*document)->surfaces()) {
    const auto first = static_cast<Index>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), surface.mesh.positions.begin(),
                          surface.mesh.positions.end());
    for (const auto& [a, b, c] : surface.mesh.triangles) {
      mesh.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return mesh;
}

}  // namespace

Result<void> run(const SampleCommand& command) {
  const Result<IndexedMesh> mesh = make_shape(command);
  if (!mesh) return mesh.error();
  if (command.clean) {
    if (Result<void> written = write_mesh(*command.clean, *mesh); !written) return written;
  }
  return write_mesh(command.output, with_normal_noise(*mesh, command.noise, command.seed));
}

Result<void> run(const CompareCommand& command) {
  const Result<IndexedMesh> reference = read_mesh(command.reference);
  if (!reference) return reference.error();
  const Result<IndexedMesh> mesh = read_mesh(command.mesh);
  if (!mesh) return mesh.error();
  if (reference->triangles != mesh->triangles) {
    return Error{ErrorCode::invalid_mesh,
                 "The two meshes have different triangles; compare a mesh with its own result."};
  }
  fmt::print("{:.3f} degrees mean face-normal error\n", mean_normal_error(*reference, *mesh));
  return {};
}

}  // namespace fairway
