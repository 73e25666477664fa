// What an inspection measures: components, boundary loops, sizes, noise.

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "core/denoise.h"
#include "core/halfedge.h"
#include "core/shapes.h"
#include "core/surface_measures.h"
#include "tests/core/generated_meshes.h"
#include "tests/core/random_meshes.h"

namespace fairway::test {
namespace {

void append(const IndexedMesh& mesh, const Vec3& shift, IndexedMesh& out) {
  const auto first = static_cast<Index>(out.positions.size());
  for (const Vec3& p : mesh.positions) out.positions.push_back(p + shift);
  for (const auto& [a, b, c] : mesh.triangles) {
    out.triangles.push_back({first + a, first + b, first + c});
  }
}

}  // namespace

TEST_CASE("closed components tell their genus, open ones have none") {
  IndexedMesh both = torus(20, 10, 1.0, 0.4);
  append(sphere(2, 1.0), Vec3(5, 0, 0), both);
  append(sheet(4), Vec3(20, 0, 0), both);
  const HalfedgeTopology topology = halfedge_topology(*TriangleMesh::build(both));
  REQUIRE(topology.pieces.size() == 3);
  CHECK(topology.components == 3);
  CHECK(topology.pieces[0].faces == 400);  // most faces first
  CHECK(topology.pieces[0].vertices == 200);
  CHECK(topology.pieces[0].genus() == 1);
  CHECK(topology.pieces[1].genus() == 0);
  CHECK(topology.pieces[1].euler_characteristic == 2);
  CHECK_FALSE(topology.pieces[2].genus());
  CHECK(topology.pieces[2].boundary_loops == 1);
  CHECK(topology.euler_characteristic == 0 + 2 + 1);
}

TEST_CASE("boundary loops have their edges and lengths, longest first") {
  // A unit square of four triangles around its middle, and a triangle of sides 3, 4, 5.
  IndexedMesh mesh{{Vec3(9, 9, 0), Vec3(12, 9, 0), Vec3(9, 13, 0), Vec3(0, 0, 0), Vec3(1, 0, 0),
                    Vec3(1, 1, 0), Vec3(0, 1, 0), Vec3(0.5, 0.5, 0)},
                   {{3, 4, 7}, {4, 5, 7}, {5, 6, 7}, {6, 3, 7}, {0, 1, 2}}};
  const HalfedgeTopology topology = halfedge_topology(*TriangleMesh::build(mesh));
  REQUIRE(topology.loops.size() == 2);
  CHECK(topology.loops[0].edges == 3);
  CHECK(topology.loops[0].length == Approx(12.0));
  CHECK(topology.loops[1].edges == 4);
  CHECK(topology.loops[1].length == Approx(4.0));
}

TEST_CASE("the loops of any mesh hold every boundary edge once, the pieces every face") {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Result<TriangleMesh> mesh = TriangleMesh::build(random_mesh(seed).mesh);
    if (!mesh) continue;
    const HalfedgeTopology topology = halfedge_topology(*mesh);
    INFO("seed " << seed);
    double length = 0.0;
    for (const Edge& edge : mesh->edges()) {
      if (!edge.interior())
        length += (mesh->positions()[edge.p] - mesh->positions()[edge.q]).norm();
    }
    std::size_t edges = 0;
    double walked = 0.0;
    for (const BoundaryLoop& loop : topology.loops) {
      edges += loop.edges;
      walked += loop.length;
    }
    CHECK(edges == mesh->counts().boundary_edges);
    CHECK(walked == Approx(length));
    std::size_t faces = 0;
    std::size_t loops = 0;
    for (const ComponentTopology& piece : topology.pieces) {
      faces += piece.faces;
      loops += piece.boundary_loops;
    }
    CHECK(faces == mesh->faces().size());
    CHECK(loops == topology.loops.size());
  }
}

TEST_CASE("sizes are those of the source's coordinates") {
  IndexedMesh mesh{{Vec3(10, 20, 30), Vec3(13, 20, 30), Vec3(10, 24, 30), Vec3(13, 24, 30.0)},
                   {{0, 1, 2}, {1, 3, 2}}};
  const SurfaceMeasures m = surface_measures(*TriangleMesh::build(mesh));
  CHECK((m.box_min - Vec3(10, 20, 30)).norm() < 1e-12);
  CHECK((m.box_max - Vec3(13, 24, 30)).norm() < 1e-12);
  CHECK(m.reach() == Approx(30.0));
  CHECK(m.edges == 5);
  CHECK(m.edge_length.least == Approx(3.0));
  CHECK(m.edge_length.largest == Approx(5.0));
  CHECK(m.edge_length.mean == Approx(19.0 / 5.0));
  CHECK(m.triangle_area.least == Approx(6.0));
  CHECK(m.triangle_area.mean == Approx(6.0));
  CHECK(m.area == Approx(12.0));
  CHECK(m.needles == 0);
  mesh.positions[0].y() = 23.99;
  CHECK(surface_measures(*TriangleMesh::build(mesh)).needles == 1);
}

TEST_CASE("an inspection finds the noise that a run reports, and says when it would do nothing") {
  const IndexedMesh clean = octahedron(16);
  for (const double noise : {0.0, 0.05, 0.2, 0.45}) {
    const TriangleMesh mesh =
        *TriangleMesh::build(noise > 0.0 ? with_normal_noise(clean, noise, 3) : clean);
    const NoiseFinding found = find_noise(mesh);
    const Result<Denoised> run = denoise(mesh, {});
    REQUIRE(run);
    INFO("noise " << noise);
    CHECK(found.noise == run->report.noise);
    CHECK(found.mean_edge_length == run->report.mean_edge_length);
    CHECK(found.clean() == run->report.steps.empty());
    CHECK(run->report.steps.size() <= static_cast<std::size_t>(found.most_steps));
    CHECK(found.clean() == (noise == 0.0));
  }
}

}  // namespace fairway::test
