// The real models that stand beside the project, where they are there.

#include <cstdlib>
#include <filesystem>

#include <catch2/catch.hpp>

#include "tests/service/temporary_directory.h"
#include "tests/tool/run_tool.h"

namespace fairway::test {
namespace {

/// The folder of shared data, or nothing, said plainly.
std::optional<std::filesystem::path> shared_data() {
  const char* named = std::getenv("FAIRWAY_SHARED");
  const std::filesystem::path shared =
      named != nullptr ? std::filesystem::path(named)
                       : std::filesystem::path(FAIRWAY_SOURCE_DIR) / ".." / "shared";
  if (std::filesystem::exists(shared / "data" / "gltf")) return shared / "data" / "gltf";
  WARN("SKIPPED: no shared data; set FAIRWAY_SHARED to run this test");
  return std::nullopt;
}

}  // namespace

TEST_CASE("real models go in and come out") {
  const auto data = shared_data();
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
