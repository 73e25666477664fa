// Every array and flow of the golden cases, within the tolerances stated with them.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "core/curvature.h"
#include "core/denoise.h"
#include "core/edge_geometry.h"
#include "core/prescribed.h"
#include "core/shape_operator.h"
#include "tests/core/golden_case.h"

namespace fairway::test {
namespace {

/// Everything the arrays speak of, computed by the library.
struct Computed {
  explicit Computed(const GoldenCase& golden)
      : mesh(*TriangleMesh::build(golden.mesh)),
        x(mesh.positions()),
        mean_edge(mean_edge_length(mesh, x)),
        faces(face_geometry(mesh, x, smallest_area(mean_edge))),
        edges(edge_mean_curvature(mesh, x, faces)),
        normals(vertex_normals(mesh, faces)),
        area(lumped_mass(mesh, faces)),
        features(detect_features(mesh, edges, golden.params.at("lam"), 10.0, 0)),
        h(mean_curvature_vector(mesh, edges, {})),
        ha(mean_curvature_vector(mesh, edges, features.weights)) {}

  PrescribedCurvature prescribed(Conventions conventions) const {
    return prescribed_curvature(mesh, x, faces, ha, features.vertex, mean_edge, {}, conventions);
  }

  std::vector<Vec3> smoothed(Conventions conventions) const {
    std::vector<Vec3> out;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      out.push_back(smoothed_mean_curvature(mesh, x, faces, ha, features.vertex, conventions, v));
    }
    return out;
  }

  TriangleMesh mesh;
  std::vector<Vec3> x;
  double mean_edge;
  FaceGeometry faces;
  EdgeCurvature edges;
  std::vector<Vec3> normals;
  std::vector<double> area;
  Features features;
  std::vector<Vec3> h, ha;
};

void check_numbers(const GoldenCase& golden, const std::string& name,
                   const std::vector<double>& ours) {
  const std::vector<double> theirs = golden.numbers(name);
  REQUIRE(ours.size() == theirs.size());
  double scale = 0.0;
  double most = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    scale = std::max(scale, std::abs(theirs[i]));
    most = std::max(most, std::abs(ours[i] - theirs[i]));
  }
  INFO(golden.name << " " << name);
  CHECK(most <= 1e-9 * scale);
}

void check_vectors(const GoldenCase& golden, const std::string& name,
                   const std::vector<Vec3>& ours) {
  const std::vector<Vec3> theirs = golden.vectors(name);
  double scale = 0.0;
  for (const Vec3& v : theirs) scale = std::max(scale, v.cwiseAbs().maxCoeff());
  INFO(golden.name << " " << name);
  CHECK(largest_difference(ours, theirs) <= 1e-9 * scale);
}

void check_directions(const GoldenCase& golden, const std::string& name,
                      const std::vector<Vec3>& ours) {
  const std::vector<Vec3> theirs = golden.vectors(name);
  const std::vector<double> k1 = golden.numbers("k1");
  const std::vector<double> k2 = golden.numbers("k2");
  double largest = 0.0;
  for (std::size_t v = 0; v < k1.size(); ++v) {
    largest = std::max({largest, std::abs(k1[v]), std::abs(k2[v])});
  }
  for (std::size_t v = 0; v < theirs.size(); ++v) {
    if (k1[v] - k2[v] <= 1e-4 * largest) continue;
    const double apart = std::min((ours[v] - theirs[v]).norm(), (ours[v] + theirs[v]).norm());
    INFO(golden.name << " " << name << " vertex " << v);
    CHECK(apart <= 1e-7);
  }
}

void check_edges(const GoldenCase& golden, const Computed& c) {
  const std::vector<double> ends = golden.numbers("edges");
  const std::vector<double> interior = golden.numbers("edge_interior");
  const std::vector<double> he = golden.numbers("edge_He");
  const std::vector<double> w = golden.numbers("edge_w");
  double scale = 0.0;
  for (const double h : he) scale = std::max(scale, std::abs(h));
  REQUIRE(c.mesh.edges().size() == he.size());
  std::vector<std::size_t> order(he.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(ends[2 * a], ends[2 * a + 1]) < std::pair(ends[2 * b], ends[2 * b + 1]);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t g = order[i];
    const Edge& e = c.mesh.edges()[i];
    REQUIRE(e.p == ends[2 * g]);
    REQUIRE(e.q == ends[2 * g + 1]);
    CHECK(e.interior() == (interior[g] != 0.0));
    CHECK(std::abs(c.edges.values[i] - he[g]) <= 1e-9 * scale);
    CHECK(std::abs(c.features.weights[i] - w[g]) <= 1e-9);
  }
}

void check_shape(const GoldenCase& golden, const Computed& c) {
  const ShapeOperator shape = shape_operator(c.mesh, c.x, c.edges, c.normals);
  std::vector<double> k1 = shape.major;
  std::vector<double> k2 = shape.minor;
  std::vector<double> trace(k1.size());
  for (std::size_t v = 0; v < k1.size(); ++v) {
    trace[v] = k1[v] + k2[v];
    k1[v] /= c.area[v];
    k2[v] /= c.area[v];
  }
  check_numbers(golden, "H_trace", trace);
  check_numbers(golden, "k1", k1);
  check_numbers(golden, "k2", k2);
  check_directions(golden, "d1", shape.major_direction);
  check_directions(golden, "d2", shape.minor_direction);
}

std::vector<Vec3> run_flow(const GoldenCase& golden, const FlowOptions& options) {
  const Result<TriangleMesh> mesh = TriangleMesh::build(golden.mesh);
  REQUIRE(mesh);
  const Result<Denoised> denoised = denoise(*mesh, options);
  REQUIRE(denoised);
  return mesh->scatter_positions(golden.mesh, denoised->positions);
}

}  // namespace

TEST_CASE("every array of the golden cases agrees") {
  const GoldenCase golden = load_golden(GENERATE("octa", "ring", "sheet", "sphere_clean"));
  const Computed c(golden);
  REQUIRE(c.mesh.vertex_count() == golden.mesh.positions.size());
  CHECK(c.mean_edge == Approx(golden.params.at("mean_edge").get<double>()).epsilon(1e-12));
  check_edges(golden, c);
  check_vectors(golden, "H", c.h);
  check_numbers(golden, "area", c.area);
  check_numbers(golden, "area_mixed", mixed_area(c.mesh, c.x, c.faces));
  check_vectors(golden, "normal", c.normals);
  check_vectors(golden, "grad_vol", volume_gradient(c.mesh, c.faces));
  check_numbers(golden, "gauss_defect", angle_defect(c.mesh, c.x, c.faces));
  check_vectors(golden, "HA", c.ha);
  check_numbers(golden, "feature", {c.features.vertex.begin(), c.features.vertex.end()});
  check_shape(golden, c);
  const PrescribedCurvature recommended = c.prescribed(Conventions::recommended);
  check_vectors(golden, "HAs", c.smoothed(Conventions::recommended));
  check_vectors(golden, "VA", recommended.direction);
  check_numbers(golden, "f", recommended.value);
  const PrescribedCurvature paper = c.prescribed(Conventions::paper);
  check_vectors(golden, "HAs_literal", c.smoothed(Conventions::paper));
  check_vectors(golden, "VA_literal", paper.direction);
  check_numbers(golden, "f_literal", paper.value);
}

TEST_CASE("every flow of the golden cases agrees") {
  const GoldenCase golden = load_golden(GENERATE("octa", "ring", "sheet"));
  const double mean_edge = golden.params.at("mean_edge");
  int flows = 0;
  for (const auto& [name, flow] : golden.params.at("flows").items()) {
    const Json& params = flow.at("params");
    FlowOptions options = golden_options(params, mean_edge);
    for (const int steps : {1, 10}) {
      options.steps = steps;
      const double tolerance = flow.at("tolerance_mean_edges").at(std::to_string(steps));
      const std::vector<Vec3> ours = run_flow(golden, options);
      const std::vector<Vec3> theirs = golden.vectors("pos_" + name + "_" + std::to_string(steps));
      INFO(golden.name << " " << name << " " << steps);
      CHECK(largest_distance(ours, theirs) / mean_edge <= tolerance);
    }
    ++flows;
  }
  CHECK(flows >= 11);
}

}  // namespace fairway::test
