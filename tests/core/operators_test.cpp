// Identities of the operators.

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <numeric>

#include <catch2/catch.hpp>

#include "core/edge_geometry.h"
#include "core/guards.h"
#include "core/shape_operator.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"

namespace fairway::test {
namespace {

struct Surface {
  explicit Surface(const IndexedMesh& source)
      : mesh(*TriangleMesh::build(source)),
        x(mesh.positions()),
        mean_edge(mean_edge_length(mesh, x)),
        faces(face_geometry(mesh, x, smallest_area(mean_edge))),
        edges(edge_mean_curvature(mesh, x, faces)) {}
  TriangleMesh mesh;
  std::vector<Vec3> x;
  double mean_edge;
  FaceGeometry faces;
  EdgeCurvature edges;
};

double total(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

IndexedMesh bumpy(const IndexedMesh& mesh) {
  return with_normal_noise(mesh, 0.2, 7);
}

}  // namespace

TEST_CASE("lumped masses and mixed areas sum to the area") {
  const Surface s(bumpy(GENERATE(sphere(3, 2.0), ring(20, 3), sheet(8))));
  const double area = surface_area(s.faces);
  CHECK(total(lumped_mass(s.mesh, s.faces)) == Approx(area).epsilon(1e-12));
  CHECK(total(mixed_area(s.mesh, s.x, s.faces)) == Approx(area).epsilon(1e-12));
}

TEST_CASE("Gauss-Bonnet: angle defects sum to 2 pi chi") {
  const auto defect = [](const IndexedMesh& mesh) {
    const Surface s(bumpy(mesh));
    return total(angle_defect(s.mesh, s.x, s.faces)) / (2.0 * std::numbers::pi);
  };
  CHECK(defect(sphere(3, 1.0)) == Approx(2.0).epsilon(0.0).margin(1e-9));
  CHECK(defect(torus(24, 12, 1.0, 0.4)) == Approx(0.0).epsilon(0.0).margin(1e-9));
  CHECK(defect(sheet(6)) == Approx(1.0).epsilon(0.0).margin(1e-9));
}

TEST_CASE("the mean curvature vector is the gradient of area, eq. (3)") {
  const Surface s(bumpy(sphere(1, 1.0)));
  const std::vector<Vec3> h = mean_curvature_vector(s.mesh, s.edges, {});
  const double step = 1e-6;
  for (const Index v : {0U, 5U, 17U}) {
    for (int c = 0; c < 3; ++c) {
      const auto area_at = [&](double offset) {
        std::vector<Vec3> moved = s.x;
        moved[v][c] += offset;
        return surface_area(face_geometry(s.mesh, moved, 0.0));
      };
      CHECK(h[v][c] == Approx((area_at(step) - area_at(-step)) / (2.0 * step)).margin(1e-8));
    }
  }
}

TEST_CASE("the volume gradient is the gradient of volume") {
  const Surface s(bumpy(sphere(1, 1.0)));
  const std::vector<Vec3> gradient = volume_gradient(s.mesh, s.faces);
  const double step = 1e-6;
  for (int c = 0; c < 3; ++c) {
    std::vector<Vec3> moved = s.x;
    moved[3][c] += step;
    const double change = enclosed_volume(s.mesh, moved) - enclosed_volume(s.mesh, s.x);
    CHECK(gradient[3][c] == Approx(change / step).margin(1e-6));
  }
}

TEST_CASE("the trace of the shape operator is the normal part of the mean curvature vector") {
  const Surface s(bumpy(GENERATE(sphere(2, 1.0), ring(16, 3), sheet(6))));
  const std::vector<Vec3> normals = vertex_normals(s.mesh, s.faces);
  const std::vector<Vec3> h = mean_curvature_vector(s.mesh, s.edges, {});
  const ShapeOperator shape = shape_operator(s.mesh, s.x, s.edges, normals);
  for (std::size_t v = 0; v < h.size(); ++v) {
    CHECK(shape.major[v] + shape.minor[v] ==
          Approx(normals[v].dot(h[v])).epsilon(0.0).margin(1e-12));
    CHECK(shape.major[v] >= shape.minor[v]);
    CHECK(std::abs(shape.major_direction[v].dot(normals[v])) < 1e-12);
    CHECK(std::abs(shape.major_direction[v].dot(shape.minor_direction[v])) < 1e-12);
    CHECK(shape.major_direction[v].norm() == Approx(1.0));
  }
}

TEST_CASE("the weight is 1 up to lambda and 1/11 at twice lambda") {
  CHECK(edge_weight(0.0, 1.0, 10.0) == 1.0);
  CHECK(edge_weight(-1.0, 1.0, 10.0) == 1.0);
  CHECK(edge_weight(-2.0, 1.0, 10.0) == Approx(1.0 / 11.0));
  CHECK(edge_weight(2e-40, 1e-40, 10.0) == Approx(1.0 / 11.0));
}

TEST_CASE("convex edges are positive, concave ones negative, boundary edges zero") {
  const Surface cube(ring(24, 1));
  double convex = 0.0;
  double concave = 0.0;
  for (const double h : cube.edges.values) (h > 0.0 ? convex : concave) += h;
  CHECK(convex > 0.0);
  CHECK(concave < 0.0);
  const Surface open(bumpy(sheet(4)));
  for (std::size_t i = 0; i < open.edges.values.size(); ++i) {
    if (!open.mesh.edges()[i].interior()) CHECK(open.edges.values[i] == 0.0);
  }
}

TEST_CASE("a right-angled edge bends by 90 degrees and H = 2 |e| sin(45 deg)") {
  IndexedMesh roof;
  roof.positions = {{0, 0, 0}, {0, 2, 0}, {-1, 1, -1}, {1, 1, -1}};
  roof.triangles = {{0, 3, 1}, {0, 1, 2}};
  const Surface s(roof);
  for (std::size_t i = 0; i < s.edges.values.size(); ++i) {
    if (!s.mesh.edges()[i].interior()) continue;
    CHECK(s.edges.dihedral_angles[i] == Approx(std::numbers::pi / 2.0));
    CHECK(s.edges.values[i] == Approx(4.0 * std::sin(std::numbers::pi / 4.0)));
  }
}

TEST_CASE("lambda and feature angle are two names of one thing") {
  for (const double angle : {5.0, 35.0, 90.0, 180.0}) {
    CHECK(feature_angle_of_lambda(lambda_of_feature_angle(angle, 0.3), 0.3) == Approx(angle));
  }
  CHECK(feature_angle_of_lambda(100.0, 0.3) == 180.0);
}

TEST_CASE("the noise estimate finds the noise that was added") {
  const double strength = GENERATE(0.1, 0.2, 0.3);
  const Surface s(with_normal_noise(octahedron(40), strength, 3));
  CHECK(noise_estimate(robust_bend(s.mesh, s.edges)) == Approx(strength).epsilon(0.15));
}

TEST_CASE("small groups of strong edges are noise, large ones features") {
  IndexedMesh source = octahedron(20);
  source.positions[100] *= 1.2;
  const Surface s(source);
  const double lambda = lambda_of_feature_angle(20.0, s.mean_edge);
  const Features all = detect_features(s.mesh, s.edges, lambda, 10.0, 0);
  const Features large = detect_features(s.mesh, s.edges, lambda, 10.0, 12);
  const auto count = [](const Features& f) {
    return std::accumulate(f.vertex.begin(), f.vertex.end(), 0);
  };
  CHECK(count(large) > 100);
  CHECK(count(all) > count(large));
  CHECK(all.vertex[100] == 1);
  CHECK(large.vertex[100] == 0);
}

TEST_CASE("unfolding leaves shapes alone whose own edges are sharper than 120 degrees") {
  IndexedMesh source;
  SECTION("the corner of a cube, cut off") {
    source.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    source.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  }
  SECTION("a blade") {
    source = octahedron(20);
    for (Vec3& p : source.positions) p.z() *= 0.18;
  }
  const TriangleMesh mesh = *TriangleMesh::build(source);
  std::vector<Vec3> x = mesh.positions();
  CHECK(unfold(mesh, std::vector<unsigned char>(x.size()), x) == 0);
  CHECK(x == mesh.positions());
}

TEST_CASE("unfolding straightens a folded vertex and leaves the boundary alone") {
  IndexedMesh source = sheet(6);
  source.positions[24] += Vec3(0.9, 0.0, 0.05);
  const TriangleMesh mesh = *TriangleMesh::build(source);
  std::vector<Vec3> x = mesh.positions();
  const std::vector<unsigned char> held(mesh.vertex_count(), 0);
  CHECK(unfold(mesh, held, x) > 0);
  CHECK(unfold(mesh, held, x) == 0);
  for (std::size_t v = 0; v < x.size(); ++v) {
    if (mesh.boundary_vertex()[v] != 0) CHECK(x[v] == mesh.positions()[v]);
  }
}

}  // namespace fairway::test
