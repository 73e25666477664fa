// The inspection document, its warnings and its estimate.

#include "proto/messages/inspection.h"

#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "core/shapes.h"
#include "proto/messages/worker_protocol.h"

namespace fairway::test {
namespace {

SurfaceInspection inspected(const IndexedMesh& source, const std::string& name = "mesh") {
  SurfaceInspection out;
  out.name = name;
  out.source_vertices = source.positions.size();
  out.source_triangles = source.triangles.size();
  const auto mesh = TriangleMesh::build(source);
  if (!mesh) {
    out.problem = mesh.error();
    return out;
  }
  out.findings =
      SurfaceFindings{mesh->counts(),           mesh->vertex_count(),    mesh->faces().size(),
                      halfedge_topology(*mesh), surface_measures(*mesh), find_noise(*mesh)};
  return out;
}

Inspection inspection_of(std::vector<SurfaceInspection> surfaces) {
  Inspection out;
  out.format = Format::ply;
  out.bytes = 1000;
  out.meshes = out.primitives = surfaces.size();
  out.surfaces = std::move(surfaces);
  return out;
}

IndexedMesh scaled(IndexedMesh mesh, double factor, const Vec3& shift = Vec3::Zero()) {
  for (Vec3& p : mesh.positions) p = p * factor + shift;
  return mesh;
}

/// Whether exactly one warning of a mesh says this.
bool warns(const IndexedMesh& mesh, const std::string& what) {
  const auto warnings = surface_warnings(inspected(mesh));
  return std::count_if(warnings.begin(), warnings.end(), [&](const std::string& warning) {
           return warning.find(what) != std::string::npos;
         }) == 1;
}

}  // namespace

TEST_CASE("the document states counts, topology, sizes and noise of every surface") {
  const Json document = inspection_document(inspection_of(
      {inspected(torus(20, 10, 1.0, 0.4), "meshes/0"), inspected(sheet(4), "meshes/1")}));
  CHECK(document["format"] == "ply");
  CHECK(document["bytes"] == 1000);
  CHECK(document["meshes"] == 2);
  CHECK(document["triangles"] == document["surfaces"][0]["source_triangles"].get<int>() +
                                     document["surfaces"][1]["source_triangles"].get<int>());
  const Json& closed = document["surfaces"][0];
  CHECK(closed["name"] == "meshes/0");
  CHECK(closed["genus"] == 1);
  CHECK(closed["boundary_loops"] == 0);
  CHECK(closed["largest_components"][0]["genus"] == 1);
  CHECK(closed["bounding_box"]["max"][0].get<double>() == Approx(1.4));
  CHECK(closed["edge_length"]["min"] <= closed["edge_length"]["mean"]);
  CHECK(closed["triangle_area"]["mean"] <= closed["triangle_area"]["max"]);
  CHECK(closed["clean"] == true);
  const Json& open = document["surfaces"][1];
  CHECK(open["genus"].is_null());
  CHECK(open["largest_boundary_loops"][0]["edges"] == open["boundary_edges"]);
}

TEST_CASE("a surface that cannot be computed with has a problem in place of findings") {
  const IndexedMesh line{{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)}, {{0, 1, 2}}};
  const Json document = inspection_document(inspection_of({inspected(line)}));
  CHECK(document["surfaces"][0]["problem"]["code"] == "invalid_mesh");
  CHECK_FALSE(document["surfaces"][0].contains("noise"));
  CHECK(document["warnings"].size() == 1);
  CHECK(document["estimate"]["steps"] == 0);
}

TEST_CASE("a clean closed surface of ordinary size has no warning") {
  CHECK(surface_warnings(inspected(sphere(3, 1.0))).empty());
}

TEST_CASE("each warning comes where it belongs and names the remedy") {
  const IndexedMesh ball = sphere(2, 1.0);
  CHECK(warns(sheet(4), "\"boundary\": \"fixed\" keeps it in place"));
  CHECK(warns(scaled(ball, 1e-6), "it is tiny"));
  CHECK(warns(scaled(ball, 1e8), "it is huge"));
  CHECK(warns(scaled(ball, 1.0, Vec3(1e6, 0, 0)), "nearer to the origin"));
  IndexedMesh fan = ball;
  fan.positions.emplace_back(0, 0, 3);
  fan.triangles.push_back(
      {fan.triangles[0][0], fan.triangles[0][1], static_cast<Index>(fan.positions.size() - 1)});
  CHECK(warns(fan, "not manifold"));
  IndexedMesh twice = ball;
  twice.triangles.push_back(ball.triangles.front());
  CHECK(warns(twice, "degenerate triangles (0) and duplicate ones (1)"));
  CHECK(warns(scaled({{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 0.001, 0)}, {{0, 1, 2}}}, 1.0),
              "needle triangles (1)"));
  SurfaceInspection doubles = inspected(scaled(ball, 1.0, Vec3(1e6, 0, 0)));
  doubles.single_precision = false;
  CHECK(surface_warnings(doubles).empty());
}

TEST_CASE("the estimate grows with size and steps, and a clean surface takes no steps") {
  const auto estimate = [](const IndexedMesh& mesh) {
    return estimate_of(inspection_of({inspected(mesh)}));
  };
  const CostEstimate clean = estimate(sphere(4, 1.0));
  const CostEstimate noisy = estimate(with_normal_noise(sphere(4, 1.0), 0.2, 1));
  const CostEstimate large = estimate(with_normal_noise(sphere(5, 1.0), 0.2, 1));
  CHECK(clean.steps == 0);
  CHECK(noisy.steps == 24);
  CHECK(clean.seconds < noisy.seconds);
  CHECK(noisy.seconds < large.seconds);
  CHECK(noisy.memory_bytes == clean.memory_bytes);
  CHECK(noisy.memory_bytes < large.memory_bytes);
}

TEST_CASE("the estimate agrees with what was measured within a factor of two") {
  const auto cost = [](Format format, std::uint64_t bytes, std::size_t vertices) {
    return estimate_cost(
        {format, bytes, vertices, 2 * vertices, 24.0 * static_cast<double>(vertices), 24});
  };
  const auto within_two = [](double estimated, double measured) {
    return estimated < 2.0 * measured && measured < 2.0 * estimated;
  };
  CHECK(within_two(cost(Format::glb, 837'012, 34'848).seconds, 1.12));
  CHECK(within_two(cost(Format::glb, 4'682'464, 130'050).seconds, 6.00));
  CHECK(within_two(cost(Format::drc, 3'525'030, 130'050).seconds, 5.15));
  CHECK(within_two(cost(Format::stl, 13'005'084, 130'050).seconds, 5.96));
  CHECK(within_two(cost(Format::glb, 35'989'800, 999'698).seconds, 47.8));
  CHECK(within_two(static_cast<double>(cost(Format::glb, 837'012, 34'848).memory_bytes), 81e6));
  CHECK(within_two(static_cast<double>(cost(Format::glb, 4'682'464, 130'050).memory_bytes), 280e6));
  CHECK(
      within_two(static_cast<double>(cost(Format::glb, 35'989'800, 999'698).memory_bytes), 2090e6));
}

TEST_CASE("a document of thousands of surfaces and warnings fits in a worker's line") {
  SurfaceInspection surface = inspected(sheet(3), "meshes/1000000");
  surface.findings->topology.loops.resize(100, surface.findings->topology.loops.front());
  surface.findings->topology.pieces.resize(100, surface.findings->topology.pieces.front());
  const Json document =
      inspection_document(inspection_of(std::vector<SurfaceInspection>(3000, surface)));
  CHECK(document["surfaces"].size() == 200);
  CHECK(document["warnings"].size() == 302);
  CHECK(document["warnings"].back() == "200 of 3000 surfaces are listed.");
  CHECK(format_line(Finished{Format::glb, document}).size() < kMaxWorkerLine / 2);
}

}  // namespace fairway::test
