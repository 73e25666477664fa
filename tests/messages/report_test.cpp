// The job report as clients read it.

#include "proto/messages/report.h"

#include <catch2/catch.hpp>

#include "core/shapes.h"
#include "proto/messages/worker_protocol.h"

namespace fairway::test {
namespace {

/// The report of a real run, as JSON.
Json report_of(const FlowOptions& options) {
  const TriangleMesh mesh = *TriangleMesh::build(with_normal_noise(octahedron(8), 0.2, 1));
  const Result<Denoised> denoised = denoise(mesh, options);
  REQUIRE(denoised);
  JobReport report;
  report.surfaces.push_back({"meshes/0", mesh.counts(), mesh.vertex_count(), mesh.faces().size(), 1,
                             0, denoised->report});
  return report_document(report)["surfaces"][0]["flow"];
}

/// A surface whose report is as long as one can be.
SurfaceReport longest(std::size_t steps) {
  FlowReport flow;
  constexpr double kLong = -1.2345678901234567e-300;
  for (std::size_t i = 0; i < steps; ++i) {
    flow.steps.push_back(
        {1'000'000, 1'000'000, kLong, kLong, kLong, kLong, 7000, kLong, 1e300, kLong, kLong});
  }
  flow.noise = flow.mean_edge_length = flow.step_size = flow.lambda = flow.feature_angle = kLong;
  flow.rms_displacement = flow.max_displacement = kLong;
  flow.volume_before = flow.area_before = 1.0 / 3.0;
  flow.notes.assign(2, std::string(100, 'n'));
  constexpr std::size_t kMany = 4'000'000'000;
  return {"meshes/1000000",
          {kMany, kMany, kMany, kMany, kMany, kMany, kMany, kMany},
          kMany,
          kMany,
          kMany,
          kMany,
          std::move(flow)};
}

}  // namespace

TEST_CASE("the longest report fits in a line of the worker's and counts what it leaves out") {
  JobReport report;
  for (int i = 0; i < 2000; ++i) report.surfaces.push_back(longest(100));
  report.notes.assign(2000, std::string(150, 'n'));
  const Json document = report_document(report);
  CHECK(format_line(Finished{Format::gltf, document}).size() < kMaxWorkerLine);
  CHECK(document["surfaces"].size() == 300);
  REQUIRE(document["notes"].size() == 502);
  CHECK(document["notes"][500] == "1500 more notes are not shown.");
  CHECK(document["notes"][501] == "300 of 2000 surfaces are reported.");
  for (const Json& surface : document["surfaces"]) CHECK_FALSE(surface["flow"]["steps"].empty());
}

TEST_CASE("a long run is thinned to an even choice of its steps, the last one kept") {
  JobReport report;
  report.surfaces.push_back(longest(10'000));
  for (std::size_t i = 0; i < 10'000; ++i) {
    report.surfaces[0].flow.steps[i].step = static_cast<int>(i) + 1;
  }
  const Json flow = report_document(report)["surfaces"][0]["flow"];
  CHECK(flow["steps_done"] == 10'000);
  CHECK(flow["steps"].size() > 190);
  CHECK(flow["steps"].size() <= 201);
  CHECK(flow["steps"].front()["step"] == 1);
  CHECK(flow["steps"].back()["step"] == 10'000);
}

TEST_CASE("the report tells what a flow found, chose and did") {
  FlowOptions options;
  options.method = Method::anisotropic_prescribed;
  options.steps = 3;
  const Json flow = report_of(options);
  INFO(flow.dump());
  CHECK(flow["noise"].get<double>() == Approx(0.2).epsilon(0.2));
  CHECK(flow["mean_edge_length"].get<double>() > 0.0);
  CHECK(flow["steps_done"] == 3);
  CHECK(flow["unfold_rounds"].is_number());
  CHECK(flow["halved_steps"] == 0);
  CHECK(flow["rms_displacement"].get<double>() > 0.0);
  CHECK(flow["max_displacement"].get<double>() >= flow["rms_displacement"].get<double>());
  CHECK(flow["volume_change"].get<double>() != 0.0);
  CHECK(flow["area_change"].get<double>() < 0.0);
  CHECK(flow["flipped_faces"].is_number());
  CHECK(flow["notes"].is_array());
  REQUIRE(flow["steps"].size() == 3);
  double displacement = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Json& step = flow["steps"][i];
    CHECK(step["step"] == i + 1);
    CHECK(step["step_size"] == 0.1);
    CHECK(step["feature_angle"].get<double>() >= 12.0);
    CHECK(step["lambda"].get<double>() > 0.0);
    CHECK(step["displacement"].get<double>() > displacement);
    displacement = step["displacement"];
    CHECK_FALSE(step.contains("solver_iterations"));
  }
  CHECK(flow["feature_angle"] == flow["steps"][2]["feature_angle"]);
  CHECK(flow["lambda"] == flow["steps"][2]["lambda"]);
}

TEST_CASE("the report tells the path of the variational method and what was chosen on it") {
  const Json flow = report_of({});
  INFO(flow.dump());
  CHECK(flow["noise"].get<double>() == Approx(0.2).epsilon(0.2));
  CHECK(flow["noise_kind"] == "white");
  const auto chosen = flow["chosen_step"].get<std::size_t>();
  REQUIRE(chosen >= 1);
  REQUIRE(flow["steps"].size() >= chosen);
  CHECK(flow["strength"].get<double>() == Approx(static_cast<double>(chosen) / 24.0));
  CHECK(flow["pass_band"] == 0.0);
  const double least = flow["steps"][chosen - 1]["cross_validation"];
  for (const Json& step : flow["steps"]) {
    CHECK(step["mu"].get<double>() > 0.0);
    CHECK(step["lambda"].get<double>() > 0.0);
    CHECK(step["degrees_of_freedom"].get<double>() > 0.0);
    CHECK(step["cross_validation"].get<double>() >= least);
    CHECK(step["solver_iterations"].get<int>() > 0);
    CHECK_FALSE(step.contains("step_size"));
  }
}

TEST_CASE("the report of a semi-implicit flow tells how each system was solved") {
  FlowOptions options;
  options.method = Method::anisotropic_prescribed;
  options.steps = 2;
  options.integration = Integration::semi_implicit;
  const Json flow = report_of(options);
  REQUIRE(flow["steps"].size() == 2);
  for (const Json& step : flow["steps"]) {
    CHECK(step["solver_iterations"].get<int>() > 0);
    CHECK(step["solver_residual"].get<double>() > 0.0);
    CHECK(step["solver_residual"].get<double>() < 1e-10);
  }
}

TEST_CASE("the report names the feature angle of a surface that did not move") {
  FlowOptions options;
  options.method = Method::none;
  options.find_features = true;
  options.feature_angle = 40.0;
  const Json flow = report_of(options);
  CHECK(flow["steps"].empty());
  CHECK(flow["feature_angle"] == 40.0);
  CHECK(flow["lambda"].get<double>() > 0.0);
}

}  // namespace fairway::test
