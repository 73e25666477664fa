// The tool as a person runs it.

#include <cmath>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "core/shapes.h"
#include "tests/formats/tinygltf_reader.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/tool/run_tool.h"

namespace fairway::test {
namespace {

/// A directory with an input file in it.
struct Workplace {
  explicit Workplace(const Bytes& input, const std::string& name = "in.glb") {
    in = directory.path() / name;
    out = directory.path() / "out.glb";
    write_bytes(in, input);
  }
  ToolRun denoise(const std::string& parameters = "{}") const {
    return run_tool({"denoise", in, out, "--params", parameters});
  }
  TemporaryDirectory directory;
  std::filesystem::path in, out;
};

IndexedMesh noisy_sphere() {
  return with_normal_noise(sphere(3, 1.0), 0.2, 1);
}

}  // namespace

TEST_CASE("a sphere of radius 2 comes back with k1 = k2 = 0.5 within 1 %") {
  const Workplace place(glb_of(sphere(4, 2.0)));
  REQUIRE(place.denoise().exit_code == 0);
  const OtherReading result = read_with_tinygltf(read_bytes(place.out), Format::glb);
  REQUIRE(result.loaded);
  for (const char* name :
       {"_CURVATURE_K1", "_CURVATURE_K2", "_CURVATURE_MEAN", "_CURVATURE_PREDOMINANT"}) {
    INFO(name);
    REQUIRE(result.attributes.count(name) == 1);
    for (const float k : result.attributes.at(name)) CHECK(k == Approx(0.5F).epsilon(0.01));
  }
}

TEST_CASE("a noisy sample comes back better and the comparison says so") {
  const TemporaryDirectory directory;
  const std::string noisy = directory.path() / "noisy.glb";
  const std::string clean = directory.path() / "clean.glb";
  const std::string result = directory.path() / "result.gltf";
  REQUIRE(run_tool({"sample", "ring", noisy, "--noise", "0.2", "--clean", clean}).exit_code == 0);
  const ToolRun run = run_tool({"denoise", noisy, result});
  CHECK(run.exit_code == 0);
  CHECK(run.output.find("noise about 0.19") != std::string::npos);
  const IndexedMesh reference = mesh_of(clean);
  CHECK(mean_normal_error(reference, mesh_of(noisy)) > 15.0);
  CHECK(mean_normal_error(reference, mesh_of(result, Format::gltf)) < 2.0);
  CHECK(run_tool({"compare", clean, noisy}).output.find(" degrees") != std::string::npos);
}

TEST_CASE("zero steps and method none keep the positions bit for bit and add curvature") {
  const Workplace place(glb_of(noisy_sphere()));
  const auto* parameters = GENERATE(R"({"steps":0})", R"({"method":"none"})");
  REQUIRE(place.denoise(parameters).exit_code == 0);
  CHECK(mesh_of(place.out).positions == mesh_of(place.in).positions);
  const OtherReading result = read_with_tinygltf(read_bytes(place.out), Format::glb);
  CHECK(result.attributes.count("_CURVATURE_DIR2") == 1);
}

TEST_CASE("the curvature verb adds attributes and leaves every other byte") {
  SampleGlb before = parse_sample(glb_of(noisy_sphere()));
  before.json["extras"] = {{"keep", "me"}};
  const Workplace place(before.glb());
  const ToolRun run = run_tool({"curvature", place.in, place.out, "--params",
                                R"({"steps":50,"curvature":["k1"],"features":true})"});
  INFO(run.output);
  REQUIRE(run.exit_code == 0);
  CHECK(run.output.find("features from") != std::string::npos);
  SampleGlb after = parse_sample(read_bytes(place.out));
  CHECK(Bytes(after.bin.begin(),
              after.bin.begin() + static_cast<std::ptrdiff_t>(before.bin.size())) == before.bin);
  Json& attributes = after.json["meshes"][0]["primitives"][0]["attributes"];
  CHECK(attributes.size() == 3);
  CHECK(floats_of(after, attributes["_CURVATURE_K1"]).size() == noisy_sphere().positions.size());
  CHECK(floats_of(after, attributes["_FEATURE"]).size() == noisy_sphere().positions.size());
  // Taken back, the document is the old one.
  attributes.erase("_CURVATURE_K1");
  attributes.erase("_FEATURE");
  for (const char* list : {"accessors", "bufferViews"}) {
    REQUIRE(after.json[list].size() == before.json[list].size() + 2);
    after.json[list].erase(after.json[list].size() - 1);
    after.json[list].erase(after.json[list].size() - 1);
  }
  after.json["buffers"] = before.json["buffers"];
  CHECK(after.json.dump() == before.json.dump());
}

TEST_CASE("feature vertices are marked on request, and only then") {
  const IndexedMesh clean = octahedron(16);
  const Workplace place(glb_of(with_normal_noise(clean, 0.1, 2)));
  REQUIRE(place.denoise(R"({"features":true})").exit_code == 0);
  const OtherReading result = read_with_tinygltf(read_bytes(place.out), Format::glb);
  REQUIRE(result.attributes.count("_FEATURE") == 1);
  const std::vector<float>& flags = result.attributes.at("_FEATURE");
  REQUIRE(flags.size() == clean.positions.size());
  std::size_t wrong = 0;
  for (std::size_t v = 0; v < flags.size(); ++v) {
    CHECK((flags[v] == 0.0F || flags[v] == 1.0F));
    const bool on_edge = clean.positions[v].cwiseAbs().minCoeff() < 1e-9;
    wrong += (flags[v] == 1.0F) != on_edge ? 1 : 0;
  }
  CHECK(wrong < flags.size() / 50);
  REQUIRE(place.denoise().exit_code == 0);
  CHECK(read_with_tinygltf(read_bytes(place.out), Format::glb).attributes.count("_FEATURE") == 0);
}

TEST_CASE("fixed vertices come back bit for bit, wrong ones are refused") {
  const Workplace place(glb_of(noisy_sphere()));
  const auto* parameters = GENERATE(R"({"fixed_vertices":[3,50]})",
                                    R"({"fixed_vertices":[{"mesh":0,"vertices":[50,3]}]})");
  REQUIRE(place.denoise(parameters).exit_code == 0);
  const IndexedMesh before = mesh_of(place.in);
  const IndexedMesh after = mesh_of(place.out);
  for (std::size_t v = 0; v < before.positions.size(); ++v) {
    CHECK((before.positions[v] == after.positions[v]) == (v == 3 || v == 50));
  }
  const ToolRun refused = place.denoise(R"({"fixed_vertices":[3,100000]})");
  CHECK(refused.exit_code == 16);
  CHECK(refused.output.find("(at /fixed_vertices/1)") != std::string::npos);
}

TEST_CASE("curvature attributes are those asked for") {
  const Workplace place(glb_of(noisy_sphere()));
  REQUIRE(place.denoise(R"({"curvature":["mean"]})").exit_code == 0);
  const OtherReading result = read_with_tinygltf(read_bytes(place.out), Format::glb);
  CHECK(result.attributes.count("_CURVATURE_MEAN") == 1);
  CHECK(result.attributes.count("_CURVATURE_K1") == 0);
}

TEST_CASE("broken inputs end with the exit code of their problem and a sentence, no output") {
  const auto check = [](const Bytes& input, int exit_code, const std::string& parameters = "{}") {
    const Workplace place(input);
    const ToolRun run = place.denoise(parameters);
    CHECK(run.exit_code == exit_code);
    CHECK(run.output.rfind("fairway: ", 0) == 0);
    CHECK_FALSE(std::filesystem::exists(place.out));
  };
  const Bytes good = glb_of(noisy_sphere());
  check({good.begin(), good.begin() + 700}, 10);
  SampleGlb out_of_range = cube_sample();
  const std::size_t indices = out_of_range.json["meshes"][0]["primitives"][0]["indices"];
  const std::size_t view = out_of_range.json["accessors"][indices]["bufferView"];
  const std::size_t offset =
      out_of_range.json["bufferViews"][view].value("byteOffset", std::size_t{0});
  out_of_range.bin[offset] = std::byte{99};
  check(out_of_range.glb(), 13);
  IndexedMesh nan = noisy_sphere();
  nan.positions[3].y() = std::nan("");
  check(glb_of(nan), 13);
  check(text_bytes("\x89PNG\r\n\x1a\n not a mesh"), 11);
  check(good, 16, R"({"stepz":3})");
  check(good, 15, R"({"steps":)");
}

TEST_CASE("the wrong command line is explained and exits with 2") {
  CHECK(run_tool({}).exit_code == 2);
  CHECK(run_tool({"dance"}).exit_code == 2);
  CHECK(run_tool({"denoise", "only-one"}).exit_code == 2);
  CHECK(run_tool({"sample", "cat", "cat.glb"}).exit_code == 2);
  CHECK(run_tool({"denoise", "/nowhere/in.glb", "/nowhere/out.exe"}).exit_code == 2);
  CHECK(run_tool({"denoise", "/nowhere/in.glb", "/nowhere/out.glb"}).exit_code == 40);
  CHECK(run_tool({"curvature", "only-one"}).exit_code == 2);
  for (const char* verb : {"denoise", "curvature"}) {
    const ToolRun help = run_tool({verb, "--help"});
    CHECK(help.exit_code == 0);
    CHECK(help.output.find("--params") != std::string::npos);
  }
}

TEST_CASE("every format is denoised into every other, told by the extensions") {
  const Workplace place(glb_of(noisy_sphere()));
  const IndexedMesh clean = sphere(3, 1.0);
  for (const Format came : {Format::ply, Format::obj, Format::stl, Format::drc}) {
    const auto noisy = place.directory.path() / fmt::format("noisy.{}", name_of(came));
    REQUIRE(run_tool({"curvature", place.in, noisy}).exit_code == 0);
    for (const Format wanted :
         {Format::ply, Format::obj, Format::stl, Format::glb, Format::gltf, Format::drc}) {
      const auto out = place.directory.path() / fmt::format("out.{}", name_of(wanted));
      const ToolRun run = run_tool({"denoise", noisy, out});
      INFO(name_of(came) << " to " << name_of(wanted) << ": " << run.output);
      REQUIRE(run.exit_code == 0);
      const bool stores = wanted != Format::obj && wanted != Format::stl;
      CHECK((run.output.find("curvature is not stored") == std::string::npos) == stores);
      // STL numbers vertices anew: roundness is compared instead of vertices.
      double worst = 0.0;
      for (const Vec3& p : mesh_of(out, wanted).positions) {
        worst = std::max(worst, std::abs(p.norm() - 1.0));
      }
      CHECK(worst < 0.03);
      CHECK(mesh_of(out, wanted).triangles.size() == clean.triangles.size());
    }
  }
}

TEST_CASE("parameters may stand in a file") {
  const Workplace place(glb_of(noisy_sphere()));
  const std::string file = place.directory.path() / "params.json";
  write_bytes(file, text_bytes(R"({"steps":0})"));
  CHECK(place.denoise(file).exit_code == 0);
  CHECK(mesh_of(place.out).positions == mesh_of(place.in).positions);
}

TEST_CASE("the tool compresses on request and tells the errors") {
  const Workplace place(glb_of(noisy_sphere()));
  const IndexedMesh clean = sphere(3, 1.0);
  const ToolRun draco = run_tool({"denoise", place.in, place.out, "--params",
                                  R"({"compression":"draco","draco":{"position_bits":16}})"});
  INFO(draco.output);
  REQUIRE(draco.exit_code == 0);
  CHECK(draco.output.find("POSITION is off by at most") != std::string::npos);
  CHECK(mesh_of(place.out).triangles.size() == clean.triangles.size());
  CHECK(parse_sample(read_bytes(place.out)).json["extensionsRequired"][0] ==
        "KHR_draco_mesh_compression");
  const auto drc = place.directory.path() / "out.drc";
  REQUIRE(run_tool({"denoise", place.in, drc, "--params", R"({"draco":{"keep_order":false}})"})
              .exit_code == 0);
  CHECK(mesh_of(drc, Format::drc).triangles.size() == clean.triangles.size());
}

}  // namespace fairway::test
