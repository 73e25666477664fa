// What `fairway denoise scene.gltf` opens beside the scene, and what it does not.

#include <catch2/catch.hpp>
#include <sys/stat.h>

#include "core/shapes.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/tool/run_tool.h"

namespace fairway::test {
namespace {

namespace fs = std::filesystem;

/// A folder with a scene, its parts below it, and a file outside.
struct SceneFolder {
  SceneFolder() : sample(parse_sample(glb_of(sphere(3, 1.0)))) {
    fs::create_directories(folder / "parts");
    write_bytes(folder / "parts" / "a mesh.bin", sample.bin);
    write_bytes(directory.path() / "outside.bin", sample.bin);
  }
  ToolRun denoise(const std::string& uri) {
    Json json = sample.json;
    json["buffers"][0]["uri"] = uri;
    write_bytes(folder / "scene.gltf", text_bytes(json.dump()));
    return run_tool({"denoise", folder / "scene.gltf", out, "--params", R"({"steps":1})"});
  }
  TemporaryDirectory directory;
  fs::path folder = directory.path() / "scene";
  fs::path out = directory.path() / "out.gltf";
  SampleGlb sample;
};

}  // namespace

TEST_CASE("a scene is read with the files beside it and written without any") {
  SceneFolder scene;
  const ToolRun run = scene.denoise("parts/a%20mesh.bin");
  INFO(run.output);
  REQUIRE(run.exit_code == 0);
  fs::remove_all(scene.folder / "parts");
  CHECK(mesh_of(scene.out, Format::gltf).triangles == sphere(3, 1.0).triangles);
}

TEST_CASE("nothing outside the folder of a scene is opened") {
  SceneFolder scene;
  for (const std::string& uri :
       {std::string("../outside.bin"), std::string("parts/../../outside.bin"),
        std::string("%2e%2e/outside.bin"), (scene.directory.path() / "outside.bin").string(),
        "file://" + (scene.directory.path() / "outside.bin").string()}) {
    const ToolRun run = scene.denoise(uri);
    INFO(uri << ": " << run.output);
    CHECK(run.exit_code == 13);
    CHECK_FALSE(fs::exists(scene.out));
  }
}

TEST_CASE("no symbolic link is followed beside a scene") {
  SceneFolder scene;
  fs::create_symlink(scene.directory.path() / "outside.bin", scene.folder / "link.bin");
  fs::create_directory_symlink(scene.directory.path(), scene.folder / "up");
  for (const char* uri : {"link.bin", "up/outside.bin"}) {
    const ToolRun run = scene.denoise(uri);
    INFO(uri << ": " << run.output);
    CHECK(run.exit_code == 40);
    CHECK(run.output.find(uri) != std::string::npos);
  }
}

TEST_CASE("what is no regular file beside a scene is refused at once") {
  SceneFolder scene;
  REQUIRE(::mkfifo((scene.folder / "pipe.bin").c_str(), 0600) == 0);
  for (const char* uri : {"pipe.bin", "parts", "absent.bin", "scene.gltf/x"}) {
    CAPTURE(uri);
    CHECK(scene.denoise(uri).exit_code == 40);
  }
}

}  // namespace fairway::test
