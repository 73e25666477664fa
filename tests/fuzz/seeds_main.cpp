// fuzz_seeds DIR: writes the seeds of every fuzz target to DIR/TARGET/NAME.

#define CATCH_CONFIG_RUNNER
#include <filesystem>
#include <fstream>
#include <iostream>

#include <catch2/catch.hpp>

#include "tests/fuzz/seeds.h"
#include "tests/fuzz/targets.h"

namespace {

std::filesystem::path& folder() {
  static std::filesystem::path path;
  return path;
}

}  // namespace

// The sample makers need a running session.
TEST_CASE("seeds are written") {
  using namespace fairway::test;
  for (const FuzzTarget& target : fuzz_targets()) {
    const auto place = folder() / target.name;
    std::filesystem::create_directories(place);
    for (const Seed& seed : seeds_of(target.name)) {
      std::ofstream file(place / seed.name, std::ios::binary);
      file.write(reinterpret_cast<const char*>(seed.bytes.data()),
                 static_cast<std::streamsize>(seed.bytes.size()));
      REQUIRE(file.good());
    }
  }
}

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: fuzz_seeds DIR\n";
    return 2;
  }
  folder() = arguments[1];
  return Catch::Session().run();
}
