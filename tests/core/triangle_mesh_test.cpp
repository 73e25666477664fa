// From any triangle list to a surface, and back.

#include "core/triangle_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include <catch2/catch.hpp>

#include "core/shapes.h"
#include "core/surface_topology.h"

namespace fairway::test {
namespace {

/// Every triangle with three vertices of its own.
IndexedMesh soup(const IndexedMesh& mesh) {
  IndexedMesh out;
  for (const Triangle& t : mesh.triangles) {
    const auto first = static_cast<Index>(out.positions.size());
    for (const Index v : t) out.positions.push_back(mesh.positions[v]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

TriangleMesh built(const IndexedMesh& mesh) {
  Result<TriangleMesh> result = TriangleMesh::build(mesh);
  REQUIRE(result);
  return *std::move(result);
}

}  // namespace

TEST_CASE("a soup welds to the closed surface it came from") {
  const IndexedMesh closed = sphere(2, 1.0);
  const TriangleMesh mesh = built(soup(closed));
  CHECK(mesh.vertex_count() == closed.positions.size());
  CHECK(mesh.counts().welded == 3 * closed.triangles.size() - closed.positions.size());
  CHECK(mesh.counts().boundary_edges == 0);
  const SurfaceTopology topology = surface_topology(mesh);
  CHECK(topology.components == 1);
  CHECK(topology.boundary_loops == 0);
  CHECK(topology.euler_characteristic == 2);
}

TEST_CASE("a clean mesh keeps its vertex order and loses nothing") {
  const IndexedMesh source = ring(24, 3);
  const TriangleMesh mesh = built(source);
  REQUIRE(mesh.vertex_count() == source.positions.size());
  CHECK(mesh.faces() == source.triangles);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    CHECK((mesh.positions()[v] + mesh.origin() - source.positions[v]).norm() < 1e-14);
  }
  CHECK(surface_topology(mesh).euler_characteristic == 0);
}

TEST_CASE("negative zero welds to zero") {
  // In every coordinate, and often enough that no accident of hashing hides a difference.
  IndexedMesh mesh = sheet(8);
  const std::size_t before = mesh.positions.size();
  for (std::size_t v = 0; v < before; ++v) {
    Vec3 p = mesh.positions[v];
    for (int c = 0; c < 3; ++c) {
      if (p[c] == 0.0) p[c] = -0.0;
    }
    mesh.positions.push_back(p);
  }
  CHECK(built(mesh).counts().welded == before);
}

TEST_CASE("degenerate and duplicate triangles are left out, not their vertices' answers") {
  IndexedMesh mesh = sphere(1, 1.0);
  const Triangle first = mesh.triangles[0];
  mesh.triangles.push_back({first[1], first[2], first[0]});
  mesh.triangles.push_back({first[0], first[0], first[1]});
  mesh.positions.emplace_back(5.0, 5.0, 5.0);
  const TriangleMesh surface = built(mesh);
  CHECK(surface.counts().duplicate_triangles == 1);
  CHECK(surface.counts().degenerate_triangles == 1);
  CHECK(surface.counts().isolated == 1);
  CHECK(surface.vertex_of_source().back() == kNoIndex);
  CHECK(surface.counts().boundary_edges == 0);
}

TEST_CASE("fans that meet in one vertex come apart and move back together") {
  // Two tetrahedra that share the vertex at the origin.
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3},
                    {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
  const TriangleMesh surface = built(mesh);
  CHECK(surface.counts().split == 1);
  CHECK(surface.vertex_count() == 8);
  CHECK(surface_topology(surface).components == 2);
  std::vector<Vec3> moved = surface.positions();
  moved[0] += Vec3(0.0, 0.0, 0.5);
  const std::vector<Vec3> back = surface.scatter_positions(mesh, moved);
  CHECK((back[0] - Vec3(0.0, 0.0, 0.25)).norm() < 1e-15);
  CHECK(back[1] == mesh.positions[1]);
}

TEST_CASE("an edge with three faces and a flipped neighbour become boundaries") {
  IndexedMesh fan;
  fan.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}};
  fan.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}};
  CHECK(built(fan).counts().boundary_edges == 9);
  IndexedMesh flipped = sheet(1);
  std::swap(flipped.triangles[1][0], flipped.triangles[1][1]);
  CHECK(built(flipped).counts().boundary_edges == 6);
}

TEST_CASE("a slit between two vertices stays open for rings and edges alike") {
  // Two tubes that touch in one edge: four faces at it, each tube's two are no pair of its own.
  IndexedMesh mesh;
  for (const double side : {1.0, -1.0}) {
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const auto& [x, y] : {std::pair(0.0, 0.0), std::pair(side, 0.5), std::pair(side, -0.5)}) {
      for (const double z : {0.0, 1.0}) mesh.positions.emplace_back(x, y, z);
    }
    for (Index k = 0; k < 3; ++k) {
      const Index a = first + 2 * k;
      const Index b = first + 2 * ((k + 1) % 3);
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  const TriangleMesh surface = built(mesh);
  std::size_t boundary = 0;
  for (const Edge& e : surface.edges()) boundary += e.interior() ? 0 : 1;
  CHECK(boundary == surface.counts().boundary_edges);
  std::size_t ring_ends = 0;
  for (const unsigned char b : surface.boundary_vertex()) ring_ends += b;
  CHECK(ring_ends == surface.vertex_count());
  CHECK(boundary == 16);
}

TEST_CASE("rings run counter-clockwise and span the faces") {
  const TriangleMesh surface = built(GENERATE(sphere(2, 1.0), sheet(5), ring(12, 1)));
  std::vector<Triangle> from_rings;
  for (Index v = 0; v < surface.vertex_count(); ++v) {
    const auto around = surface.rings()[v];
    const std::size_t faces = around.size() - surface.boundary_vertex()[v];
    for (std::size_t k = 0; k < faces; ++k) {
      const Index a = around[k];
      const Index b = around[(k + 1) % around.size()];
      if (v < a && v < b) from_rings.push_back({v, a, b});
    }
  }
  std::vector<Triangle> faces = surface.faces();
  for (Triangle& f : faces) std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  std::sort(faces.begin(), faces.end());
  std::sort(from_rings.begin(), from_rings.end());
  CHECK(faces == from_rings);
}

TEST_CASE("an open sheet has one boundary loop and knows its boundary vertices") {
  const TriangleMesh surface = built(sheet(4));
  CHECK(surface.counts().boundary_edges == 16);
  CHECK(surface_topology(surface).boundary_loops == 1);
  const auto& boundary = surface.boundary_vertex();
  CHECK(std::count(boundary.begin(), boundary.end(), 1) == 16);
}

TEST_CASE("a vertex of very high valence is no trouble") {
  IndexedMesh star;
  constexpr Index kValence = 20000;
  star.positions.emplace_back(0.0, 0.0, 1.0);
  for (Index i = 0; i < kValence; ++i) {
    const double a = 2.0 * M_PI * i / kValence;
    star.positions.emplace_back(std::cos(a), std::sin(a), 0.0);
    star.triangles.push_back({0, 1 + i, 1 + (i + 1) % kValence});
  }
  CHECK(built(star).vertex_edges()[0].size() == kValence);
}

TEST_CASE("meshes without usable triangles are refused with a remedy") {
  const auto code = [](const IndexedMesh& mesh) {
    const Result<TriangleMesh> result = TriangleMesh::build(mesh);
    REQUIRE_FALSE(result);
    CHECK(result.error().message.size() > 20);
    return result.error().code;
  };
  IndexedMesh line;
  line.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  CHECK(code(line) == ErrorCode::no_triangles);
  line.triangles = {{0, 1, 2}};
  CHECK(code(line) == ErrorCode::invalid_mesh);
  line.triangles = {{0, 1, 1}};
  CHECK(code(line) == ErrorCode::invalid_mesh);
  IndexedMesh huge = sheet(1);
  huge.positions[0].x() = 3e38;
  CHECK(code(huge) == ErrorCode::invalid_mesh);
  huge.positions[0].x() = std::numeric_limits<double>::quiet_NaN();
  CHECK(code(huge) == ErrorCode::invalid_mesh);
}

TEST_CASE("a coordinate that is not a number is refused by name, whichever it is") {
  for (int c = 0; c < 3; ++c) {
    for (const double bad : {std::nan(""), HUGE_VAL, -2e18}) {
      IndexedMesh mesh = sphere(1, 1.0);
      mesh.positions[3][c] = bad;
      const Result<TriangleMesh> built = TriangleMesh::build(mesh);
      REQUIRE_FALSE(built);
      CHECK(built.error().message.find("not a number") != std::string::npos);
    }
  }
}

TEST_CASE("a vertex that does not move keeps even the sign of its zeros") {
  IndexedMesh source = sphere(1, 1.0);
  source.positions[0] = Vec3(-0.0, 1.0, -0.0);
  const TriangleMesh mesh = *TriangleMesh::build(source);
  const std::vector<Vec3> out = mesh.scatter_positions(source, mesh.positions());
  CHECK(std::signbit(out[0].x()));
  CHECK(std::signbit(out[0].z()));
}

namespace {

/// Every index a vertex of its own.
Weld unwelded(const IndexedMesh& mesh) {
  Weld weld;
  weld.count = mesh.positions.size();
  for (Index i = 0; i < mesh.positions.size(); ++i) weld.place.push_back(i);
  return weld;
}

void append(IndexedMesh& mesh, const IndexedMesh& other, bool reversed = false) {
  const auto first = static_cast<Index>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) {
    mesh.triangles.push_back(reversed ? Triangle{a + first, c + first, b + first}
                                      : Triangle{a + first, b + first, c + first});
  }
}

}  // namespace

TEST_CASE("two shells at one place move as one, and no triangle of either is lost") {
  const bool reversed = GENERATE(false, true);
  const IndexedMesh one = sphere(2, 1.0);
  IndexedMesh two = one;
  append(two, one, reversed);
  const TriangleMesh surface = built(two);
  // Computed with once, in the direction of the first.
  CHECK(surface.faces() == built(one).faces());
  CHECK(surface.counts().duplicate_triangles == one.triangles.size());
  CHECK(surface.counts().welded == one.positions.size());
  CHECK(surface.counts().split == 0);
  CHECK(surface.counts().boundary_edges == 0);
  std::vector<Vec3> moved = surface.positions();
  for (Vec3& p : moved) p *= 0.9;
  const std::vector<Vec3> back = surface.scatter_positions(two, moved);
  REQUIRE(back.size() == two.positions.size());
  for (std::size_t v = 0; v < one.positions.size(); ++v) {
    CHECK(back[v] == back[v + one.positions.size()]);
    CHECK((back[v] - 0.9 * one.positions[v]).norm() < 1e-14);
  }
}

TEST_CASE("shells that share a part of their surface come apart there and keep together") {
  // Two cubes, one on the other: the shared face is there twice, in opposite directions.
  IndexedMesh cube;
  for (const double z : {0.0, 1.0}) {
    for (const auto& [x, y] : {std::pair(0.0, 0.0), {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      cube.positions.emplace_back(x, y, z);
    }
  }
  cube.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                    {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  IndexedMesh upper = cube;
  for (Vec3& p : upper.positions) p.z() += 1.0;
  upper.triangles[0] = {0, 3, 1};  // the other diagonal: same places, no equal triangles
  upper.triangles[1] = {1, 3, 2};
  IndexedMesh two = cube;
  append(two, upper);
  const TriangleMesh surface = built(two);
  CHECK(surface.counts().duplicate_triangles == 0);
  CHECK(surface.faces().size() == two.triangles.size());
  CHECK(surface.counts().welded == 4);
  CHECK(surface.counts().split > 0);
  std::vector<Vec3> moved = surface.positions();
  for (std::size_t v = 0; v < moved.size(); ++v) moved[v].x() += 0.01 * static_cast<double>(v);
  const std::vector<Vec3> back = surface.scatter_positions(two, moved);
  for (std::size_t k = 0; k < 4; ++k) CHECK(back[4 + k] == back[8 + k]);
}

TEST_CASE("without a weld, shells that touch stay apart and cracks stay open") {
  const IndexedMesh one = sphere(2, 1.0);
  IndexedMesh two = one;
  append(two, one);
  Result<TriangleMesh> apart = TriangleMesh::build(two, unwelded(two));
  REQUIRE(apart);
  CHECK(apart->vertex_count() == two.positions.size());
  CHECK(apart->faces() == two.triangles);
  CHECK(apart->counts().welded == 0);
  CHECK(apart->counts().duplicate_triangles == 0);
  CHECK(surface_topology(*apart).components == 2);
  // Each moves by itself.
  std::vector<Vec3> moved = apart->positions();
  moved[3] += Vec3(0.5, 0.0, 0.0);
  const std::vector<Vec3> back = apart->scatter_positions(two, moved);
  CHECK(back[3] != two.positions[3]);
  CHECK(back[3 + one.positions.size()] == two.positions[3]);
  const IndexedMesh cracked = soup(sheet(2));
  Result<TriangleMesh> open = TriangleMesh::build(cracked, unwelded(cracked));
  REQUIRE(open);
  CHECK(open->counts().boundary_edges == 3 * cracked.triangles.size());
}

TEST_CASE("without a weld, a large mesh in no order answers as one in order") {
  const IndexedMesh tidy = sphere(7, 1.0);
  IndexedMesh shuffled = tidy;
  for (std::size_t i = 1; i < shuffled.triangles.size(); ++i) {
    std::swap(shuffled.triangles[i], shuffled.triangles[i * 7919 % (i + 1)]);
  }
  Result<TriangleMesh> mesh = TriangleMesh::build(shuffled, unwelded(shuffled));
  REQUIRE(mesh);
  CHECK(mesh->counts().boundary_edges == 0);
  std::vector<Vec3> moved = mesh->positions();
  for (Vec3& p : moved) p *= 2.0;
  const std::vector<Vec3> back = mesh->scatter_positions(shuffled, moved);
  double worst = 0.0;
  for (std::size_t v = 0; v < back.size(); ++v) {
    worst = std::max(worst, (back[v] - 2.0 * tidy.positions[v]).norm());
  }
  CHECK(worst < 1e-12);
}

}  // namespace fairway::test
