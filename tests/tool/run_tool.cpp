#include "tests/tool/run_tool.h"

#include <fstream>
#include <iterator>

#include <catch2/catch.hpp>
#include <fcntl.h>

#include "proto/formats/fresh_gltf.h"
#include "server/os/child_process.h"
#include "server/os/file.h"
#include "tests/places.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::test {

ToolRun run_tool(const std::vector<std::string>& arguments) {
  const TemporaryDirectory scratch;
  const std::filesystem::path log = scratch.path() / "log";
  const Result<UniqueFd> in = open_file("/dev/null", O_RDONLY);
  const Result<UniqueFd> out = open_file(log, O_RDWR | O_CREAT | O_APPEND);
  REQUIRE(in);
  REQUIRE(out);
  Result<ChildProcess> child =
      ChildProcess::spawn({.program = program("fairway"),
                           .arguments = arguments,
                           .environment = {},
                           .descriptors = {in->get(), out->get(), out->get()}});
  REQUIRE(child);
  const ExitStatus status = child->wait();
  const Bytes text = read_bytes(log);
  return {status.signal == 0 ? status.code : -1,
          {reinterpret_cast<const char*>(text.data()), text.size()}};
}

Bytes read_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  INFO(path);
  REQUIRE(in.good());
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return text_bytes(text);
}

void write_bytes(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  REQUIRE(out.good());
}

Bytes glb_of(const IndexedMesh& mesh) {
  const FreshMesh fresh{mesh.triangles, {{"POSITION", pack_vectors(mesh.positions)}}};
  Result<std::vector<std::byte>> bytes = write_fresh_gltf(fresh, Format::glb);
  REQUIRE(bytes);
  return *std::move(bytes);
}

IndexedMesh mesh_of(const std::filesystem::path& path, Format format) {
  const Bytes bytes = read_bytes(path);
  const Decoded document = decoded(bytes, format);
  REQUIRE(document->surfaces().size() == 1);
  return document->surfaces()[0].mesh;
}

}  // namespace fairway::test
