#include "tests/places.h"

#include <cstdlib>
#include <iostream>

namespace fairway::test {

std::string program(std::string_view name) {
  return std::string(FAIRWAY_BIN_DIR "/").append(name);
}

std::string preloaded(std::string_view name) {
  return std::string(FAIRWAY_MODULE_DIR "/lib").append(name).append(".so");
}

std::filesystem::path source(std::string_view path) {
  return std::filesystem::path(FAIRWAY_SOURCE_DIR) / path;
}

std::optional<std::filesystem::path> shared(std::string_view path) {
  const char* named = std::getenv("FAIRWAY_SHARED");
  const std::filesystem::path folder =
      (named != nullptr ? std::filesystem::path(named) : source("..") / "shared") / path;
  if (std::filesystem::exists(folder)) return folder;
  std::cout << "SKIPPED: no " << folder << "; set FAIRWAY_SHARED to run this test\n";
  return std::nullopt;
}

}  // namespace fairway::test
