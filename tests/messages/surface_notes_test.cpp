// Sentences about surfaces.

#include "proto/messages/surface_notes.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

namespace fairway::test {
namespace {

SurfaceReport surface(std::size_t index) {
  SurfaceReport out;
  out.name = fmt::format("meshes/{}", index);
  out.counts.welded = 12;
  out.boundary_loops = 2;
  return out;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a surface to which nothing was done gets no sentence") {
  CHECK(surface_notes({}).empty());
  const std::vector<SurfaceReport> clean(3, surface(0));
  CHECK(surface_notes(clean).empty());
}

TEST_CASE("what was split or left out is one sentence with its counts") {
  std::vector<SurfaceReport> reports = {surface(0), surface(1)};
  SurfaceCounts& counts = reports[1].counts;
  counts.split = 1;
  counts.degenerate_triangles = 2;
  counts.duplicate_triangles = 3;
  counts.isolated = 4;
  const auto notes = surface_notes(reports);
  REQUIRE(notes.size() == 1);
  INFO(notes[0]);
  CHECK(notes[0].starts_with("meshes/1: 1 vertex was split"));
  CHECK(has(notes[0], "2 triangles without three distinct corners"));
  CHECK(has(notes[0], "3 triangles on the corners of another"));
  CHECK(has(notes[0], "4 vertices that no such triangle uses"));
  CHECK(has(notes[0], "12 vertices welded, 2 boundary loops"));
  counts.duplicate_triangles = counts.isolated = counts.split = 0;
  CHECK(surface_notes(reports)[0] ==
        "meshes/1: 2 triangles without three distinct corners left out of the computation (12 "
        "vertices welded, 2 boundary loops); the file keeps all of them");
}

TEST_CASE("thousands of surfaces do not flood the notes") {
  std::vector<SurfaceReport> reports;
  for (std::size_t i = 0; i < 5000; ++i) {
    reports.push_back(surface(i));
    reports.back().counts.split = 1;
    reports.back().why_local = "it is skinned";
    reports.back().color_limit = 1.0 + static_cast<double>(i);
  }
  const auto notes = surface_notes(reports);
  CHECK(notes.size() == 83);
  CHECK(has(notes[40], "4960 more meshes"));
  CHECK(has(notes[41], "meshes/0: curvature stays in local lengths: it is skinned"));
  CHECK(has(notes.back(), "from 1 to 5000"));
}

TEST_CASE("the range of the colours is stated") {
  std::vector<SurfaceReport> reports(2, surface(0));
  reports[1].color_limit = 2.5;
  const auto notes = surface_notes(reports);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0] == "colours: predominant curvature from -2.5 (blue) to 2.5 (red)");
}

TEST_CASE("scale and limit of the colours stand in the report where they were asked for") {
  JobReport report;
  report.surfaces.push_back(surface(0));
  const Json plain = report_document(report)["surfaces"][0];
  CHECK_FALSE(plain.contains("world_scale"));
  CHECK_FALSE(plain.contains("color_limit"));
  report.surfaces[0].world_scale = 3.0;
  report.surfaces[0].color_limit = 0.5;
  const Json told = report_document(report)["surfaces"][0];
  CHECK(told["world_scale"] == 3.0);
  CHECK(told["color_limit"] == 0.5);
}

}  // namespace fairway::test
