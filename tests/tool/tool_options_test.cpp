// What is denoised, what is one vertex, and what is told of the curvature, through the program.

#include <cmath>

#include <catch2/catch.hpp>

#include "core/shapes.h"
#include "tests/formats/tinygltf_reader.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/tool/run_tool.h"

namespace fairway::test {
namespace {

/// A directory with an input file in it.
struct Workplace {
  explicit Workplace(const Bytes& input) {
    in = directory.path() / "in.glb";
    out = directory.path() / "out.glb";
    write_bytes(in, input);
  }
  ToolRun denoise(const std::string& parameters) const {
    return run_tool({"denoise", in, out, "--params", parameters});
  }
  TemporaryDirectory directory;
  std::filesystem::path in, out;
};

/// Several meshes, each with its node.
SampleGlb scene_of(const std::vector<IndexedMesh>& meshes) {
  SampleGlb sample = empty_sample();
  sample.json["nodes"] = Json::array();
  for (const IndexedMesh& mesh : meshes) {
    std::vector<std::array<float, 3>> positions;
    positions.reserve(mesh.positions.size());
    for (const Vec3& p : mesh.positions) {
      positions.push_back(
          {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
    }
    std::vector<std::uint32_t> indices;
    for (const Triangle& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
    const std::size_t position = sample.add_vec3(positions);
    const Json attributes = {{"POSITION", position}};
    const std::size_t added = sample.add_mesh(
        Json::array({{{"attributes", attributes}, {"indices", sample.add_indices(indices)}}}));
    sample.json["nodes"].push_back({{"mesh", added}});
  }
  return sample;
}

IndexedMesh noisy_sphere() {
  return with_normal_noise(sphere(3, 1.0), 0.2, 1);
}

bool contains(const ToolRun& run, const std::string& text) {
  return run.output.find(text) != std::string::npos;
}

}  // namespace

TEST_CASE("meshes that are not selected come back untouched, and the notes say so") {
  const SampleGlb before = scene_of({noisy_sphere(), noisy_sphere(), noisy_sphere()});
  const Workplace place(before.glb());
  const auto* parameters = GENERATE(R"({"meshes":[1]})", R"({"nodes":[1]})",
                                    R"({"meshes":[1],"nodes":[1],"compression":"draco"})");
  const ToolRun run = place.denoise(parameters);
  INFO(run.output);
  REQUIRE(run.exit_code == 0);
  CHECK(contains(run, "not selected, so left as they are: meshes/0, meshes/2"));
  const SampleGlb after = parse_sample(read_bytes(place.out));
  for (const std::size_t mesh : {0U, 2U}) {
    CHECK(after.json["meshes"][mesh] == before.json["meshes"][mesh]);
  }
  CHECK(after.json["meshes"][1]["primitives"][0]["attributes"].contains("_CURVATURE_K1"));
  CHECK(Bytes(after.bin.begin(),
              after.bin.begin() + static_cast<std::ptrdiff_t>(before.bin.size())) == before.bin);
}

TEST_CASE("a selection of what is not there is refused with its pointer") {
  const Workplace place(scene_of({noisy_sphere(), noisy_sphere()}).glb());
  const auto check = [&](const std::string& parameters, const std::string& pointer) {
    const ToolRun run = place.denoise(parameters);
    INFO(run.output);
    CHECK(run.exit_code == 16);
    CHECK(contains(run, "(at " + pointer + ")"));
  };
  check(R"({"meshes":[0,2]})", "/meshes/1");
  check(R"({"nodes":[5]})", "/nodes/0");
  check(R"({"meshes":[]})", "/meshes");
}

TEST_CASE("shells at one place move as one with a weld, and each by itself without") {
  const IndexedMesh one = noisy_sphere();
  IndexedMesh two = one;
  const auto count = static_cast<Index>(one.positions.size());
  two.positions.insert(two.positions.end(), one.positions.begin(), one.positions.end());
  for (const auto& [a, b, c] : one.triangles) {
    two.triangles.push_back({a + count, b + count, c + count});
  }
  const Workplace place(glb_of(two));
  const ToolRun welded = place.denoise("{}");
  REQUIRE(welded.exit_code == 0);
  CHECK(contains(welded, "1280 triangles on the corners of another left out of it"));
  const IndexedMesh together = mesh_of(place.out);
  CHECK(together.triangles == two.triangles);
  for (Index v = 0; v < count; ++v) CHECK(together.positions[v] == together.positions[v + count]);

  const ToolRun apart = place.denoise(R"({"weld":"none","fixed_vertices":[5]})");
  REQUIRE(apart.exit_code == 0);
  CHECK_FALSE(contains(apart, "left out of it"));
  const IndexedMesh moved = mesh_of(place.out);
  CHECK(moved.positions[5] == mesh_of(place.in).positions[5]);
  CHECK(moved.positions[5 + count] != mesh_of(place.in).positions[5 + count]);
}

TEST_CASE(
    "curvature is that of the scene where the mesh has one scale there, else a note says why") {
  SampleGlb sample = scene_of({sphere(4, 2.0)});
  sample.json["nodes"][0]["scale"] = {-4, 4, 4};
  const Workplace place(sample.glb());
  const std::string keys = R"({"method":"none","curvature":["mean","gaussian","dir1"],)";
  const auto check = [&](const std::string& space, float mean) {
    const ToolRun run = place.denoise(keys + R"("curvature_space":")" + space + R"("})");
    INFO(run.output);
    REQUIRE(run.exit_code == 0);
    const OtherReading result = read_with_tinygltf(read_bytes(place.out), Format::glb);
    for (const float k : result.attributes.at("_CURVATURE_MEAN")) {
      CHECK(k == Approx(mean).epsilon(0.01));
    }
    for (const float k : result.attributes.at("_CURVATURE_GAUSSIAN")) {
      CHECK(k == Approx(mean * mean).epsilon(0.03));
    }
    CHECK_FALSE(contains(run, "stays in local lengths"));
  };
  check("local", 0.5F);
  check("world", 0.125F);
  sample.json["nodes"][0]["scale"] = {4, 4, 5};
  write_bytes(place.in, sample.glb());
  const ToolRun run = place.denoise(R"({"method":"none","curvature_space":"world"})");
  CHECK(contains(run, "meshes/0: curvature stays in local lengths: its scale is not uniform"));
}

TEST_CASE("colours show the predominant curvature and their range is told") {
  const Workplace place(glb_of(sphere(3, 2.0)));
  const ToolRun run = place.denoise(R"({"colors":{"limit":0.5},"curvature":[]})");
  INFO(run.output);
  REQUIRE(run.exit_code == 0);
  CHECK(contains(run, "colours: predominant curvature from -0.5 (blue) to 0.5 (red)"));
  const SampleGlb out = parse_sample(read_bytes(place.out));
  const Json& attributes = out.json["meshes"][0]["primitives"][0]["attributes"];
  CHECK(attributes.size() == 2);
  CHECK(attributes.contains("COLOR_0"));
  const ToolRun again =
      run_tool({"denoise", place.out, place.in, "--params", R"({"colors":true})"});
  CHECK(contains(again, "1 primitive keeps the colours"));
  const auto obj = place.directory.path() / "out.obj";
  const ToolRun lost = run_tool({"denoise", place.in, obj, "--params", R"({"colors":true})"});
  CHECK(contains(lost, "OBJ has no place for attributes"));
}

}  // namespace fairway::test
