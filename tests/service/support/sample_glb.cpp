#include "tests/service/support/sample_glb.h"

#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <fmt/format.h>

#include "server/os/child_process.h"
#include "server/os/file.h"
#include "tests/places.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::test {
namespace {

template <class T>
std::string bytes_of(const T& values) {
  std::string bytes(sizeof values, '\0');
  std::memcpy(bytes.data(), &values, sizeof values);
  return bytes;
}

std::string chunk(std::string_view type, std::string content) {
  while (content.size() % 4 != 0) content += ' ';
  return bytes_of(static_cast<std::uint32_t>(content.size())) + std::string(type) + content;
}

}  // namespace

std::string small_glb(Flaw flaw) {
  std::array<float, 12> positions{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<std::uint32_t, 12> indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  if (flaw == Flaw::not_a_number) positions[4] = std::numeric_limits<float>::quiet_NaN();
  if (flaw == Flaw::index_out_of_range) indices[5] = 4;
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)"
      R"("min":[0,0,0],"max":[1,1,1]},)"
      R"({"bufferView":1,"componentType":5125,"count":12,"type":"SCALAR"}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":48},)"
      R"({"buffer":0,"byteOffset":48,"byteLength":48}],"buffers":[{"byteLength":96}]})";
  const std::string chunks = chunk("JSON", json) + chunk(std::string_view("BIN\0", 4),
                                                         bytes_of(positions) + bytes_of(indices));
  std::string glb = "glTF" + bytes_of(std::uint32_t{2}) +
                    bytes_of(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
  if (flaw == Flaw::truncated) glb.resize(glb.size() - 50);
  return glb;
}

std::string noisy_torus(int size) {
  const TemporaryDirectory directory;
  const auto path = directory.path() / "torus.glb";
  const auto null = open_file("/dev/null", O_RDWR);
  REQUIRE(null);
  auto tool = ChildProcess::spawn(
      {program("fairway"),
       {"sample", "torus", path.string(), "--noise", "0.2", "--size", fmt::to_string(size)},
       {},
       {null->get(), null->get(), null->get()}});
  REQUIRE(tool);
  REQUIRE(tool->wait().code == 0);
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace fairway::test
