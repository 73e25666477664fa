#include "tests/core/golden_case.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <catch2/catch.hpp>

#include "tests/places.h"

namespace fairway::test {
namespace {

std::string read_text(const std::string& path) {
  std::ifstream in(path);
  INFO(path);
  REQUIRE(in.good());
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

IndexedMesh parse_off(const std::string& text) {
  std::istringstream in(text);
  std::string magic;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t edges = 0;
  in >> magic >> vertices >> faces >> edges;
  REQUIRE(magic == "OFF");
  IndexedMesh mesh;
  for (std::size_t i = 0; i < vertices; ++i) {
    Vec3 p;
    in >> p.x() >> p.y() >> p.z();
    mesh.positions.push_back(p);
  }
  for (std::size_t i = 0; i < faces; ++i) {
    int corners = 0;
    Triangle t{};
    in >> corners >> t[0] >> t[1] >> t[2];
    REQUIRE(corners == 3);
    mesh.triangles.push_back(t);
  }
  REQUIRE(in);
  return mesh;
}

}  // namespace

std::vector<double> GoldenCase::numbers(const std::string& array) const {
  return arrays.at(array).at("data").get<std::vector<double>>();
}

std::vector<Vec3> GoldenCase::vectors(const std::string& array) const {
  const std::vector<double> flat = numbers(array);
  std::vector<Vec3> out;
  for (std::size_t i = 0; i + 2 < flat.size(); i += 3)
    out.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
  return out;
}

GoldenCase load_golden(const std::string& name) {
  const std::string stem = source("tests/core/golden/" + name).string();
  GoldenCase out;
  out.name = name;
  out.mesh = parse_off(read_text(stem + ".off"));
  out.params = Json::parse(read_text(stem + ".params.json"));
  out.arrays = Json::parse(read_text(stem + ".arrays.json")).at("arrays");
  return out;
}

FlowOptions golden_options(const Json& p, double mean_edge) {
  FlowOptions options;
  const std::string flow = p.at("flow");
  const bool isotropic = p.at("lam").is_string();
  if (flow == "amc") options.method = Method::anisotropic;
  if (flow == "apmc") options.method = Method::anisotropic_prescribed;
  if (flow == "mcf") options.method = Method::mean_curvature;
  if (flow == "ipmc") options.method = Method::prescribed;
  if (!isotropic) options.lambda = p.at("lam").get<double>();
  options.transition = p.at("r");
  options.step_size = p.at("s").get<double>() / (mean_edge * mean_edge);
  if (p.at("scheme") == "implicit") options.integration = Integration::semi_implicit;
  options.mass = p.at("mass") == "full" ? Mass::full : Mass::lumped;
  if (p.at("f_mode") == "project") options.measure = CurvatureMeasure::project;
  options.boundary = p.at("boundary") == "fixed" ? Boundary::fixed : Boundary::free;
  options.curvature_smoothing = {p.at("smooth_iter"), p.at("smooth_mu")};
  options.conventions =
      p.at("hs") == "all" && p.at("mix") == "all" ? Conventions::paper : Conventions::recommended;
  options.guards = {.unfold = false, .min_component = 0, .local_step = false};
  return options;
}

double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, (a[i] - b[i]).cwiseAbs().maxCoeff());
  }
  return most;
}

double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

}  // namespace fairway::test
