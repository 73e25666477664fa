// Seeds of files that hold one mesh: Draco, PLY, OBJ, STL.

#include <catch2/catch.hpp>

#include "core/normals.h"
#include "core/shapes.h"
#include "proto/formats/fresh_mesh.h"
#include "tests/formats/draco_samples.h"
#include "tests/fuzz/seeds.h"

namespace fairway::test {
namespace {

/// Colours with alpha and texture coordinates.
VertexExtras extras_of(std::size_t vertices) {
  VertexExtras out;
  out.colors.components = 4;
  for (std::size_t i = 0; i < 4 * vertices; ++i) {
    out.colors.values.push_back(static_cast<float>(i % 256) / 255.0F);
  }
  for (std::size_t i = 0; i < 2 * vertices; ++i) {
    out.texture_coordinates.push_back(static_cast<float>(i) / 16.0F);
  }
  return out;
}

/// A generated shape as our own writer writes it, with attributes where they have a place.
Bytes written(const IndexedMesh& mesh, Format format, VertexExtras extras = {}) {
  Surface surface;
  surface.name = "mesh";
  surface.mesh = mesh;
  SurfaceResult result;
  std::vector<float> ramp;
  for (std::size_t i = 0; i < 3 * mesh.positions.size(); ++i) ramp.push_back(static_cast<float>(i));
  result.attributes.push_back({"_CURVATURE_DIR1", 3, ramp});
  surface.normals.assign(mesh.positions.size(), Vec3::UnitZ());
  auto file = write_fresh_mesh(surface, result, format, {}, std::move(extras));
  REQUIRE(file);
  return file->bytes.joined();
}

std::vector<Seed> ply_texts() {
  return {{"ascii", text_bytes("ply\nformat ascii 1.0\ncomment sample\nelement vertex 5\n"
                               "property double x\nproperty double y\nproperty double z\n"
                               "property float nx\nproperty float ny\nproperty float nz\n"
                               "property uchar red\nelement face 3\n"
                               "property list uchar int vertex_index\nproperty list int float t\n"
                               "end_header\n0 0 0 0 0 1 7\n1 0 0 0 0 1 7\n1 1 0 0 0 1 7\n"
                               "0 1 0 0 0 1 7\n0.5 0.5 1e0 0 0 1 7\n4 3 2 1 0 1 0.5\n3 0 1 4 0\n"
                               "3 1 2 4 2 1 2\n")},
          {"colors", text_bytes("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                "property float y\nproperty float z\nproperty float red\n"
                                "property ushort green\nproperty uchar blue\n"
                                "property double alpha\nproperty float texture_u\n"
                                "property float texture_v\nelement face 1\n"
                                "property list uchar int vertex_index\nend_header\n"
                                "0 0 0 1 65535 255 1 0 0\n1 0 0 0.5 7 8 0 nan 1\n"
                                "0 1 0 0 0 0 0.5 2 -1\n3 0 1 2\n")},
          {"strips", text_bytes("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                                "property float y\nproperty float z\nelement tristrips 1\n"
                                "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n"
                                "0 1 0\n1 1 1\n9 0 1 2 3 -1 0 2 1 3\n")},
          {"big_endian",
           text_bytes("ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\n"
                      "property float y\nproperty float z\nelement face 1\n"
                      "property list uchar ushort vertex_indices\nend_header\n" +
                      std::string("\0\0\0\0\0\0\0\0\0\0\0\0\x3f\x80\0\0\0\0\0\0\0\0\0\0"
                                  "\0\0\0\0\x3f\x80\0\0\0\0\0\0\x03\0\0\0\1\0\2",
                                  43))}};
}

std::vector<Seed> obj_texts() {
  return {{"all", text_bytes("# sample\nmtllib a.mtl\no cube\nv 0 0 0\nv 1 0 0 1\nv 1 1 0\n"
                             "v 0 1 0 0.5 0.5 0.5\nv 0.5 .5 1e0\nvt 0 0\nvt 1 1\nvn 0 0 1\n"
                             "vn 0 0 -1\ng a\nusemtl m\ns 1\nf 4/1/2 3/2/2 2/1/2 1/1/2\n"
                             "f 1//1 2//1 5//1\nf 2/1 3/2 5/1\nf -3 -2 -1\nf 4 1 \\\n5\nl 1 2 3\n"
                             "p 1\n")},
          {"colors", text_bytes("v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0.5\n"
                                "vt 1\nvt 1 1 1\nf 1/3 2/2 3/1\nf 3/1 2/2 1/3\n")},
          {"windows", text_bytes("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n")}};
}

std::vector<Seed> stl_texts() {
  return {{"ascii", text_bytes("solid sample\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"
                               "   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n endfacet\n"
                               " facet normal 0 -1 0\n  outer loop\n   vertex 0 0 0\n"
                               "   vertex 0 0 1\n   vertex 1 0 0\n  endloop\n endfacet\n"
                               "endsolid sample\n")}};
}

}  // namespace

std::vector<Seed> drc_seeds() {
  std::vector<Seed> out = {{"point_cloud", draco_point_cloud()}};
  for (const bool edgebreaker : {false, true}) {
    const std::string name = edgebreaker ? "edgebreaker" : "sequential";
    out.push_back({name, draco_cube({.edgebreaker = edgebreaker})});
    out.push_back({name + "_all", draco_cube({edgebreaker, true, true, true})});
  }
  return out;
}

std::vector<Seed> shape_seeds(Format format) {
  std::vector<Seed> out;
  if (format == Format::ply) out = ply_texts();
  if (format == Format::obj) out = obj_texts();
  if (format == Format::stl) out = stl_texts();
  out.push_back({"sphere", written(sphere(1, 2.0), format)});
  out.push_back({"sheet", written(sheet(3), format)});
  out.push_back({"ring", written(ring(8, 1), format)});
  const IndexedMesh colored = octahedron(1);
  out.push_back({"colored", written(colored, format, extras_of(colored.positions.size()))});
  IndexedMesh far = octahedron(1);
  for (Vec3& position : far.positions) position += Vec3(1e5, 0, 0);
  out.push_back({"far", written(far, format)});
  return out;
}

}  // namespace fairway::test
