// The fuzz targets over their seeds, over seeded mutations of them, and over the hostile files that
// stand beside the project, where they do.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include <catch2/catch.hpp>

#include "tests/fuzz/mutations.h"
#include "tests/fuzz/seeds.h"
#include "tests/fuzz/targets.h"
#include "tests/places.h"

namespace fairway::test {
namespace {

Bytes read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE(file);
  return text_bytes(std::string((std::istreambuf_iterator<char>(file)), {}));
}

/// The targets for a file, by its folder and extension.
std::vector<std::string_view> targets_for(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  if (file.parent_path().filename() == "http") return {"http_head", "connection"};
  if (file.parent_path().filename() == "params") return {"parameters", "worker_order"};
  for (const char* format : {"glb", "gltf", "drc", "ply", "obj", "stl"}) {
    if (extension == std::string(".") + format) return {format, "recognition"};
  }
  return {};
}

/// Draco's decoder may spin for seconds on what it does not understand.
int mutations_of(std::string_view target) {
  const bool may_spin = target == "drc" || target == "draco_glb";
  return may_spin ? 100 : 400;
}

void check_promises(const FuzzTarget& target, const Bytes& bytes, const std::string& what) {
  const std::string defect = target.run(bytes);
  INFO(target.name << ": " << what << ": " << defect);
  CHECK(defect.empty());
}

}  // namespace

TEST_CASE("every seed of every fuzz target keeps the target's promises") {
  for (const FuzzTarget& target : fuzz_targets()) {
    const auto seeds = seeds_of(target.name);
    CHECK(seeds.size() >= 3);
    for (const Seed& seed : seeds) {
      check_promises(target, seed.bytes, seed.name);
    }
  }
}

TEST_CASE("most seeds of meshes are accepted") {
  for (const char* name : {"glb", "meshopt_glb", "draco_glb", "drc", "ply", "obj", "stl", "gltf"}) {
    const std::string target = name;
    const auto format = format_of_name(target.substr(target.find('_') + 1));
    REQUIRE(format);
    std::size_t accepted = 0;
    const auto seeds = seeds_of(name);
    for (const Seed& seed : seeds) {
      if (decode(seed.bytes, *format)) ++accepted;
    }
    CAPTURE(target);
    CHECK(4 * accepted >= 3 * seeds.size());
  }
}

TEST_CASE("mutated seeds keep the promises of their fuzz target") {
  for (const FuzzTarget& target : fuzz_targets()) {
    Random random(1);
    for (const Seed& seed : seeds_of(target.name)) {
      for (int i = 0; i < mutations_of(target.name); ++i) {
        Bytes bytes = mutated(seed.bytes, random);
        for (std::uint64_t more = random() % 3; more > 0; --more) bytes = mutated(bytes, random);
        check_promises(target, bytes, seed.name + ", mutation " + std::to_string(i));
      }
    }
  }
}

TEST_CASE("hostile files keep the promises of the fuzz targets") {
  const auto folder = test::shared("bad");
  if (!folder) return;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(*folder)) {
    if (!entry.is_regular_file()) continue;
    const Bytes bytes = read_file(entry.path());
    for (const std::string_view name : targets_for(entry.path())) {
      const FuzzTarget* target = find_fuzz_target(name);
      REQUIRE(target != nullptr);
      check_promises(*target, bytes, entry.path().string());
    }
  }
}

}  // namespace fairway::test
