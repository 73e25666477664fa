// Where the clean meshes come from.

#include "tests/quality/cases.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>

#include "core/shapes.h"
#include "proto/formats/ply_surface.h"
#include "tests/places.h"

namespace fairway::quality {
namespace {

std::vector<std::byte> contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::byte> bytes(text.size());
  std::transform(text.begin(), text.end(), bytes.begin(),
                 [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

/// A sphere with hills of several sizes: smooth and detailed as bodies are.
IndexedMesh hills(Index levels) {
  IndexedMesh mesh = sphere(levels, 1.0);
  for (Vec3& p : mesh.positions) {
    const double height = 0.10 * std::sin(5.0 * p.x()) * std::cos(4.0 * p.y()) +
                          0.05 * std::sin(11.0 * p.y() + 3.0 * p.z()) +
                          0.02 * std::sin(23.0 * p.z()) * std::cos(19.0 * p.x());
    p *= 1.0 + height;
  }
  return mesh;
}

/// An open sheet, bent over an edge down its middle and waved on one side.
IndexedMesh folded_sheet(Index n) {
  IndexedMesh mesh = sheet(n);
  for (Vec3& p : mesh.positions) {
    p.z() = 0.6 * std::abs(p.x()) + (p.x() > 0.0 ? 0.05 * std::sin(6.0 * p.y()) * p.x() : 0.0);
  }
  return mesh;
}

}  // namespace

std::vector<std::string> shared_models() {
  return {"fandisk", "octahedron", "ring", "block", "bunny", "armadillo173k"};
}

std::vector<std::string> generated_models() {
  return {"made_octahedron", "made_ring", "made_torus", "made_hills", "made_sheet"};
}

std::optional<Model> model(const std::string& name) {
  if (name == "made_octahedron") return Model{name, octahedron(48), true};
  if (name == "made_ring") return Model{name, ring(248, 5), true};
  if (name == "made_torus") return Model{name, torus(160, 60, 1.0, 0.4)};
  if (name == "made_hills") return Model{name, hills(5)};
  if (name == "made_sheet") return Model{name, folded_sheet(96), true};
  const auto file = test::shared("data/denoise/" + name + ".ply");
  if (!file || !std::filesystem::exists(*file)) {
    std::cerr << "quality: there is no model " << name << '\n';
    return std::nullopt;
  }
  const std::vector<std::byte> bytes = contents(*file);
  const auto read = read_ply_surface(bytes);
  if (!read) {
    std::cerr << "quality: " << name << ": " << read.error().message << '\n';
    return std::nullopt;
  }
  return Model{name, read->surface.mesh, name != "bunny" && name != "armadillo173k"};
}

}  // namespace fairway::quality
