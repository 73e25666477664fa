// The real models that stand beside the project, where they are there.

#include <filesystem>

#include <catch2/catch.hpp>

#include "tests/places.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/tool/run_tool.h"

namespace fairway::test {

TEST_CASE("real models go in and come out") {
  const auto data = shared("data/gltf");
  if (!data) return;
  const std::string name =
      GENERATE("duck.glb", "bunny.drc", "bunny_draco.gltf", "CesiumMan.glb", "mengerSponge3.glb",
               "BoxInterleaved.glb", "MeshPrimitiveModes.gltf", "CesiumBalloonKTX2.glb");
  const TemporaryDirectory directory;
  const auto extension = std::filesystem::path(name).extension();
  const std::string out = directory.path() / (extension == ".gltf" ? "out.gltf" : "out.glb");
  const ToolRun run = run_tool({"denoise", *data / name, out});
  INFO(name << ": " << run.output);
  CHECK(run.exit_code == 0);
  CHECK(std::filesystem::exists(out));
}

}  // namespace fairway::test
