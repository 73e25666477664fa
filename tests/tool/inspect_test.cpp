// `fairway inspect` and the outputs of `fairway sample`, as a person runs them.

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "core/shapes.h"
#include "proto/messages/json.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/tool/run_tool.h"

namespace fairway::test {
namespace {

Json inspection_of(const std::filesystem::path& file) {
  const ToolRun run = run_tool({"inspect", file, "--json"});
  INFO(run.output);
  REQUIRE(run.exit_code == 0);
  Result<Json> document = parse_json(run.output);
  REQUIRE(document);
  return *std::move(document);
}

}  // namespace

TEST_CASE("a torus is inspected as one closed component of genus 1, with its noise") {
  const TemporaryDirectory directory;
  const auto noisy = directory.path() / "torus.glb";
  const auto clean = directory.path() / "clean.glb";
  REQUIRE(run_tool({"sample", "torus", noisy, "--size", "30", "--clean", clean}).exit_code == 0);
  const Json document = inspection_of(noisy);
  const Json& surface = document["surfaces"][0];
  CHECK(document["bytes"] == std::filesystem::file_size(noisy));
  CHECK(surface["vertices"] == 1800);
  CHECK(surface["faces"] == 3600);
  CHECK(surface["edges"] == 5400);
  CHECK(surface["components"] == 1);
  CHECK(surface["euler_characteristic"] == 0);
  CHECK(surface["genus"] == 1);
  CHECK(surface["clean"] == false);
  const ToolRun run = run_tool({"denoise", noisy, directory.path() / "out.glb"});
  CHECK(run.output.find(fmt::format("noise about {:.3f}", surface["noise"].get<double>())) !=
        std::string::npos);
  CHECK(inspection_of(clean)["surfaces"][0]["clean"] == true);
  CHECK(inspection_of(clean)["estimate"]["steps"] == 0);
}

TEST_CASE("the table says what the document says, in lines for people") {
  const TemporaryDirectory directory;
  const auto file = directory.path() / "sheet.ply";
  REQUIRE(run_tool({"sample", "sheet", file}).exit_code == 0);
  const ToolRun run = run_tool({"inspect", file});
  CHECK(run.exit_code == 0);
  for (const char* part :
       {"ply, ", "components 1, boundary loops 1", "edge length   mean", "noise         about 0.",
        "a default run: 24 steps", "- mesh: it is open"}) {
    INFO(part << " in " << run.output);
    CHECK(run.output.find(part) != std::string::npos);
  }
}

TEST_CASE("a glTF's inspection counts its parts and names what a run leaves untouched") {
  SampleGlb sample = cube_sample();
  sample.json["meshes"].push_back(sample.json["meshes"][0]);
  sample.json["meshes"][0]["primitives"].push_back(
      {{"attributes", sample.json["meshes"][0]["primitives"][0]["attributes"]}, {"mode", 0}});
  sample.json["animations"] = Json::array({{{"channels", Json::array()}}});
  const TemporaryDirectory directory;
  const auto file = directory.path() / "cube.glb";
  write_bytes(file, sample.glb());
  const Json document = inspection_of(file);
  CHECK(document["meshes"] == 2);
  CHECK(document["primitives"] == 3);
  CHECK(document["surfaces"].size() == 2);
  CHECK(document["warnings"].dump().find("points and lines stay as they are") != std::string::npos);
  CHECK(document["warnings"].dump().find("1 animation: kept") != std::string::npos);
  const auto draco = directory.path() / "draco.glb";
  REQUIRE(run_tool({"denoise", file, draco, "--params", R"({"compression":"draco","steps":1})"})
              .exit_code == 0);
  CHECK(inspection_of(draco)["warnings"].dump().find("compressed with Draco") != std::string::npos);
}

TEST_CASE("a mesh that cannot be computed with is a finding, a broken file is an error") {
  const TemporaryDirectory directory;
  const auto flat = directory.path() / "flat.obj";
  write_bytes(flat, text_bytes("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"));
  CHECK(inspection_of(flat)["surfaces"][0]["problem"]["code"] == "invalid_mesh");
  const auto broken = directory.path() / "broken.obj";
  write_bytes(broken, text_bytes("v 0 0 nan\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"));
  const ToolRun run = run_tool({"inspect", broken});
  CHECK(run.exit_code == 13);
  CHECK(run.output.find("finite") != std::string::npos);
  CHECK(run_tool({"inspect"}).exit_code == 2);
}

TEST_CASE("a sample is written in the format that its name chooses") {
  const TemporaryDirectory directory;
  for (const Format format :
       {Format::glb, Format::gltf, Format::drc, Format::ply, Format::obj, Format::stl}) {
    const auto file = directory.path() / fmt::format("s.{}", name_of(format));
    REQUIRE(run_tool({"sample", "sphere", file, "--size", "3"}).exit_code == 0);
    const Bytes bytes = read_bytes(file);
    const auto head = std::span(bytes).first(std::min(bytes.size(), kMagicBytes));
    const auto recognised = recognise_format(head, "", "");
    REQUIRE(recognised);
    CHECK(*recognised == format);
    CHECK(mesh_of(file, format).triangles.size() == sphere(3, 1.0).triangles.size());
  }
  CHECK(run_tool({"sample", "sphere", directory.path() / "s.exe"}).exit_code == 2);
}

}  // namespace fairway::test
