#include "tests/service/support/sample_scene.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <catch2/catch.hpp>
#include <fcntl.h>

#include "server/os/child_process.h"
#include "server/os/file.h"
#include "tests/places.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::test {
namespace {

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

}  // namespace

std::string form_body(const std::vector<FormPart>& parts) {
  std::string body;
  for (const FormPart& part : parts) {
    body += "--an-edge\r\nContent-Disposition: form-data; name=\"" + part.name + '"';
    if (!part.file_name.empty()) body += "; filename=\"" + part.file_name + '"';
    body += "\r\n\r\n" + part.content + "\r\n";
  }
  return body + "--an-edge--\r\n";
}

SampleScene::SampleScene(int size) {
  const std::string glb = noisy_torus(size);
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, sizeof length);
  json = Json::parse(glb.substr(20, length));
  bin = glb.substr(28 + length);
  json["buffers"][0]["byteLength"] = bin.size();
  json["buffers"][0]["uri"] = "scene%20data%c3%A4.bin";
  json["images"] = Json::array({{{"uri", "skins/%61.png"}}});
}

std::vector<FormPart> SampleScene::parts(const std::string& parameters) const {
  return {{"scene", "scene.gltf", gltf()},
          {"any", kBin, bin},
          {kPng, "", png},
          {"params", "", parameters}};
}

std::string denoised_by_tool(const SampleScene& scene, const std::string& out,
                             const std::string& parameters) {
  const TemporaryDirectory directory;
  const auto folder = directory.path() / "scene";
  write_text(folder / "scene.gltf", scene.gltf());
  write_text(folder / SampleScene::kBin, scene.bin);
  write_text(folder / SampleScene::kPng, scene.png);
  const auto null = open_file("/dev/null", O_RDWR);
  REQUIRE(null);
  auto tool = ChildProcess::spawn({program("fairway"),
                                   {"denoise", (folder / "scene.gltf").string(),
                                    (directory.path() / out).string(), "--params", parameters},
                                   {},
                                   {null->get(), null->get(), null->get()}});
  REQUIRE(tool);
  REQUIRE(tool->wait().code == 0);
  std::ifstream file(directory.path() / out, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace fairway::test
