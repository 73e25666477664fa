// Meshes at the edge of what libdraco's own decoder takes.

#include <fstream>

#include <catch2/catch.hpp>
#include <sys/resource.h>

#include "proto/formats/draco_encoder.h"
#include "proto/formats/draco_parts.h"
#include "proto/formats/fresh_mesh.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// `used` triangles in a fan about vertex 0, and vertices that may be more than they need.
Surface fan(Index vertices, Index used) {
  Surface out;
  out.name = "mesh";
  for (Index i = 0; i < vertices; ++i) out.mesh.positions.emplace_back(i % 7, i / 7, 0.1 * i);
  for (Index i = 0; i < used; ++i) {
    out.mesh.triangles.push_back({0, 1 + i % (vertices - 2), 2 + i % (vertices - 2)});
  }
  return out;
}

Result<Encoded> as_drc(const Surface& surface, bool keep_order) {
  DracoOptions options;
  options.keep_order = keep_order;
  return write_fresh_draco(surface, {}, options);
}

}  // namespace

TEST_CASE("any number of vertices and triangles is written as readable Draco, or refused") {
  for (const Index vertices : {3U, 4U, 6U, 7U, 16U, 99U, 1000U}) {
    for (const Index triangles : {1U, 2U, 3U, 5U, 33U, 334U}) {
      CAPTURE(vertices, triangles);
      const Surface surface = fan(vertices, triangles);
      const auto kept = as_drc(surface, true);
      CHECK(static_cast<bool>(kept) == (vertices <= 3 * triangles));
      if (kept) {
        const auto again = decoded(kept->bytes.joined(), Format::drc);
        CHECK(again->surfaces()[0].mesh.triangles == surface.mesh.triangles);
        CHECK(again->surfaces()[0].mesh.positions.size() == vertices);
      } else {
        CHECK(kept.error().code == ErrorCode::unsupported_feature);
        CHECK(kept.error().message.find("keep_order") != std::string::npos);
      }
    }
  }
}

TEST_CASE("a mesh of any size is off by no more than half a step and the rounding of floats") {
  for (const double scale : {1e-20, 1e-9, 1e-6, 1e-3, 1.0, 1e6, 1e20}) {
    for (const double shift : {0.0, 1.0 / 3.0, -1.7e3}) {
      CAPTURE(scale, shift);
      Surface surface = fan(100, 98);
      for (Vec3& position : surface.mesh.positions)
        position = scale * (position + shift * Vec3(1, 1, 1));
      const auto out = as_drc(surface, true);
      REQUIRE(out);
      const double error = make_surface_grids(surface.mesh.positions, {}, {}).position->error;
      const auto again = decoded(out->bytes.joined(), Format::drc);
      for (std::size_t i = 0; i < 100; ++i) {
        const Vec3 off = again->surfaces()[0].mesh.positions[i] - surface.mesh.positions[i];
        CHECK(off.cwiseAbs().maxCoeff() <= error);
      }
    }
  }
}

TEST_CASE("many bits need no more memory than the mesh") {
  // Address space for what the process has, and half a gibibyte: far below a table of 2^30 counts.
  rlimit before{};
  REQUIRE(getrlimit(RLIMIT_AS, &before) == 0);
  std::ifstream status("/proc/self/statm");
  rlim_t pages = 0;
  status >> pages;
  rlimit tight = before;
  tight.rlim_cur = pages * 4096 + (rlim_t{512} << 20U);
  Surface surface = fan(100, 98);
  surface.normals.assign(100, Vec3(0.6, 0.0, 0.8));
  REQUIRE(setrlimit(RLIMIT_AS, &tight) == 0);
  std::vector<Result<Encoded>> out;
  for (const bool keep_order : {true, false}) {
    out.push_back(write_fresh_draco(surface, {}, {30, 30, 30, 30, 10, keep_order}));
  }
  REQUIRE(setrlimit(RLIMIT_AS, &before) == 0);
  for (const auto& stream : out) {
    if (!stream) FAIL(stream.error().message);
    const auto again = decoded(stream->bytes.joined(), Format::drc);
    CHECK(again->surfaces()[0].mesh.triangles.size() == 98);
  }
}

TEST_CASE("unused vertices that are too many for Draco are left out where order is free") {
  const auto out = as_drc(fan(100, 3), false);
  REQUIRE(out);
  const auto again = decoded(out->bytes.joined(), Format::drc);
  CHECK(again->surfaces()[0].mesh.triangles.size() == 3);
  CHECK(again->surfaces()[0].mesh.positions.size() == 5);
}

TEST_CASE("a primitive with too many unused vertices for Draco stays plain, and that is said") {
  SampleGlb sample = cube_sample();
  Json& primitive = sample.json["meshes"][0]["primitives"][0];
  primitive["indices"] = sample.add_indices({0, 1, 2, 1, 2, 3});
  const auto document = decoded(sample.glb());
  const auto out =
      document->write(shifted(*document, Vec3(1, 0, 0)), Format::glb, {Compression::draco, {}});
  REQUIRE(out);
  REQUIRE(out->notes.size() == 1);
  CHECK(out->notes[0].find("1 primitives are not compressed") != std::string::npos);
  CHECK(decoded(out->bytes.joined())->surfaces()[0].mesh.positions.size() == 8);
}
