// Guards around the plain flows: is there noise at all, unfolding before the first step, a stable
// step per vertex.

#include "core/guards.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/edge_geometry.h"
#include "core/median.h"
#include "core/union_find.h"

namespace fairway {
namespace {

constexpr int kUnfoldRounds = 10;
constexpr double kFolded = 120.0 * std::numbers::pi / 180.0;
// Noise of 0.3 mean edges folds less than one edge in a hundred, and rarely two in a row.
constexpr double kLargestShare = 0.1;
constexpr int kBladeVertices = 12;

/// Folded edges, by index; none where so many are folded that this is the surface's shape.
std::vector<std::size_t> folded_edges(const TriangleMesh& mesh, std::span<const Vec3> positions) {
  const double mean_edge = mean_edge_length(mesh, positions);
  const FaceGeometry faces = face_geometry(mesh, positions, smallest_area(mean_edge));
  const EdgeCurvature edges = edge_mean_curvature(mesh, positions, faces);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < mesh.edges().size(); ++i) {
    if (std::abs(edges.dihedral_angles[i]) > kFolded) out.push_back(i);
  }
  const double share = static_cast<double>(out.size()) / static_cast<double>(mesh.edges().size());
  if (share > kLargestShare) out.clear();
  return out;
}

/// Vertices of folded edges that may move. A long line of such edges is no fold but a blade.
std::vector<Index> folded_vertices(const TriangleMesh& mesh, std::span<const unsigned char> held,
                                   std::span<const Vec3> positions) {
  const std::vector<std::size_t> folded = folded_edges(mesh, positions);
  if (folded.empty()) return {};
  UnionFind groups(mesh.vertex_count());
  for (const std::size_t i : folded) groups.unite(mesh.edges()[i].p, mesh.edges()[i].q);
  std::vector<int> group_size(mesh.vertex_count(), 0);
  for (Index v = 0; v < mesh.vertex_count(); ++v) ++group_size[groups.find(v)];
  std::vector<unsigned char> marked(mesh.vertex_count(), 0);
  for (const std::size_t i : folded) {
    const Edge& e = mesh.edges()[i];
    if (group_size[groups.find(e.p)] >= kBladeVertices) continue;
    marked[e.p] = marked[e.q] = marked[e.opposite0] = marked[e.opposite1] = 1;
  }
  std::vector<Index> out;
  for (Index v = 0; v < marked.size(); ++v) {
    if (marked[v] != 0 && mesh.boundary_vertex()[v] == 0 && held[v] == 0) out.push_back(v);
  }
  return out;
}

Vec3 neighbour_mean(const TriangleMesh& mesh, std::span<const Vec3> positions, Index v) {
  Vec3 sum = Vec3::Zero();
  const auto edges = mesh.vertex_edges()[v];
  for (const Index i : edges) sum += positions[other_end(mesh.edges()[i], v)];
  return sum / static_cast<double>(edges.size());
}

}  // namespace

int unfold(const TriangleMesh& mesh, std::span<const unsigned char> held,
           std::vector<Vec3>& positions) {
  for (int round = 0; round < kUnfoldRounds; ++round) {
    const std::vector<Index> vertices = folded_vertices(mesh, held, positions);
    if (vertices.empty()) return round;
    std::vector<Vec3> targets;
    targets.reserve(vertices.size());
    for (const Index v : vertices) {
      targets.emplace_back(0.5 * (positions[v] + neighbour_mean(mesh, positions, v)));
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) positions[vertices[i]] = targets[i];
  }
  return kUnfoldRounds;
}

double curvature_roughness(const TriangleMesh& mesh, std::span<const Vec3> positions,
                           const FaceGeometry& faces, const EdgeCurvature& edges) {
  const std::vector<Vec3> vectors = mean_curvature_vector(mesh, edges, {});
  const std::vector<Vec3> normals = vertex_normals(mesh, faces);
  std::vector<double> h = mixed_area(mesh, positions, faces);
  for (std::size_t v = 0; v < h.size(); ++v) {
    h[v] = h[v] > 0.0 ? normals[v].dot(vectors[v]) / h[v] : 0.0;
  }
  std::vector<double> size;
  std::vector<double> deviation;
  for (Index v = 0; v < h.size(); ++v) {
    if (mesh.boundary_vertex()[v] != 0) continue;
    double sum = 0.0;
    const auto around = mesh.vertex_edges()[v];
    for (const Index i : around) sum += h[other_end(mesh.edges()[i], v)];
    size.push_back(std::abs(h[v]));
    deviation.push_back(std::abs(h[v] - sum / static_cast<double>(around.size())));
  }
  const double scale = median(size);
  return scale > 0.0 ? median(deviation) / scale : 0.0;
}

std::vector<double> largest_stable_step(const TriangleMesh& mesh, std::span<const Vec3> positions,
                                        const FaceGeometry& faces) {
  std::vector<double> out(mesh.vertex_count(), 0.0);
  for (Index v = 0; v < out.size(); ++v) {
    double sum = 0.0;
    for (const Index f : mesh.vertex_faces()[v]) {
      if (!faces.present(f)) continue;
      const Triangle& t = mesh.faces()[f];
      const unsigned slot = t[0] == v ? 0U : t[1] == v ? 1U : 2U;
      const Vec3& p = positions[v];
      const Vec3& q = positions[t[(slot + 1) % 3]];
      const Vec3& r = positions[t[(slot + 2) % 3]];
      const double twice = 2.0 * faces.areas[f];
      sum += std::abs(cotangent_at(q, r, p, twice)) + std::abs(cotangent_at(r, p, q, twice));
    }
    if (sum > 0.0) out[v] = 1.0 / sum;
  }
  return out;
}

}  // namespace fairway
