// Large meshes in no order, and welds too large for one table.

#include "core/spatial_order.h"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "core/curvature.h"
#include "core/shapes.h"
#include "core/weld.h"
#include "tests/core/generated_meshes.h"

namespace fairway::test {
namespace {

/// The mean distance of two corners of a face, in vertices.
double mean_span(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const Triangle& f : mesh.faces()) {
    const auto [least, most] = std::minmax({f[0], f[1], f[2]});
    sum += static_cast<double>(most - least);
  }
  return sum / static_cast<double>(mesh.faces().size());
}

IndexedMesh large_torus() {
  return torus(400, 200, 1.0, 0.4);
}

}  // namespace

TEST_CASE("a large mesh in no order is put in order, and answers for each source vertex") {
  const IndexedMesh natural = large_torus();
  const Relabelled random = relabelled(natural, 5);
  const TriangleMesh mesh = *TriangleMesh::build(random.mesh);
  const TriangleMesh known = *TriangleMesh::build(natural);
  // A curve through n cells of a surface leads back to a neighbour after about √n.
  CHECK(mean_span(mesh) < 0.05 * static_cast<double>(mesh.vertex_count()));
  CHECK(mesh.counts().split == 0);
  CHECK(mesh.counts().boundary_edges == 0);
  CHECK(mesh.scatter_positions(random.mesh, mesh.positions()) == random.mesh.positions);
  const CurvatureFields k = scatter(mesh, curvature(mesh, mesh.positions()));
  const CurvatureFields expected = scatter(known, curvature(known, known.positions()));
  double worst = 0.0;
  for (std::size_t v = 0; v < natural.positions.size(); ++v) {
    worst = std::max(worst, std::abs(k.k1[random.new_of_old[v]] - expected.k1[v]));
  }
  CHECK(worst < 1e-9);
}

TEST_CASE("a large mesh in order keeps the order of its vertices and faces") {
  const IndexedMesh source = large_torus();
  const TriangleMesh mesh = *TriangleMesh::build(source);
  CHECK(mesh.faces() == source.triangles);
}

TEST_CASE("of two faces on the same corners the earlier stays, in no order too") {
  Relabelled random = relabelled(large_torus(), 5);
  const Triangle first = random.mesh.triangles.front();
  random.mesh.triangles.push_back({first[1], first[0], first[2]});
  const TriangleMesh mesh = *TriangleMesh::build(random.mesh);
  CHECK(mesh.counts().duplicate_triangles == 1);
  CHECK(mesh.counts().boundary_edges == 0);
}

TEST_CASE("small meshes are never reordered") {
  const Relabelled random = relabelled(torus(40, 20, 1.0, 0.4), 5);
  CHECK_FALSE(in_no_order(random.mesh.triangles, random.mesh.positions.size()));
}

TEST_CASE("a weld of many positions numbers its classes by first appearance") {
  // Each position three times, in no order.
  Random random(9);
  std::vector<Index> names(150'000);
  for (std::size_t i = 0; i < names.size(); ++i) {
    names[i] = static_cast<Index>(i / 3);
    std::swap(names[i], names[random.below(i + 1)]);
  }
  std::vector<Vec3> positions;
  positions.reserve(names.size());
  for (const Index name : names) positions.emplace_back(name % 100, name / 100 % 100, name / 10000);
  const Weld weld = weld_equal_positions(positions);
  CHECK(weld.count == names.size() / 3);
  std::vector<Index> expected(weld.count, kNoIndex);
  Index next = 0;
  bool right = true;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (expected[names[i]] == kNoIndex) expected[names[i]] = next++;
    right = right && weld.place[i] == expected[names[i]];
  }
  CHECK(right);
}

}  // namespace fairway::test
