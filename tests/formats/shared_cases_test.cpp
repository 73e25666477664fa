// The hostile files that stand beside the project, where they do: each must get its class of
// answer.

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "core/triangle_mesh.h"
#include "proto/formats/document.h"
#include "proto/messages/problem.h"
#include "tests/formats/sample_glb.h"
#include "tests/places.h"

using namespace fairway;
using namespace fairway::test;

namespace {

Bytes read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  REQUIRE(file);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  return text_bytes(text);
}

/// "accept", or the HTTP status of the refusal.
std::string answer_of(const Result<void>& result) {
  return result ? "accept" : fmt::format("{}", problem_kind(result.error().code).status);
}

/// What the service does with an upload before any flow runs.
Result<void> take(const Bytes& bytes, const std::string& folder, const std::string& name) {
  const bool by_bytes = folder == "drc" || folder == "repro" || folder == "mesh";
  const std::string declared = folder == "gltf" ? "model/gltf+json"
                               : by_bytes       ? "application/octet-stream"
                                                : "model/gltf-binary";
  const auto head = std::span(bytes).first(std::min(bytes.size(), kMagicBytes));
  const auto format = recognise_format(head, declared, name);
  if (!format) return format.error();
  // What was sent as Draco is read as Draco.
  const auto document = decode(bytes, folder == "drc" ? Format::drc : *format);
  if (!document) return document.error();
  for (const Surface& surface : (*document)->surfaces()) {
    const auto mesh = TriangleMesh::build(surface.mesh);
    if (!mesh) return mesh.error();
  }
  const auto out = (*document)->encode(unmoved(**document), Format::glb);
  if (!out) return out.error();
  if (folder != "mesh") return {};
  const auto same = (*document)->encode(shifted(**document, Vec3(0, 0, 1)), *format);
  if (!same) return same.error();
  return {};
}

bool concerns_us(const std::string& folder, const std::string& extension) {
  if (folder == "repro") return extension != ".json";
  return folder == "glb" || folder == "geo" || folder == "gltf" || folder == "drc" ||
         folder == "khr" || folder == "mesh";
}

}  // namespace

TEST_CASE("every hostile mesh file gets its class of answer") {
  const auto folder = shared("bad");
  if (!folder) return;
  const Bytes text = read_file(*folder / "manifest.json");
  const Json manifest =
      Json::parse(std::string(reinterpret_cast<const char*>(text.data()), text.size()));
  int seen = 0;
  for (const Json& item : manifest["files"]) {
    const std::filesystem::path file = item["file"].get<std::string>();
    const std::string kind = file.parent_path().string();
    if (!concerns_us(kind, file.extension().string())) continue;
    ++seen;
    const Result<void> result = take(read_file(*folder / file), kind, file.filename().string());
    const auto expected = fmt::format("|{}|", item["expected"].get<std::string>());
    const auto found = fmt::format("|{}|", answer_of(result));
    INFO(file.string() << ": " << (result ? "accepted" : result.error().message));
    CHECK_THAT(expected, Catch::Matchers::Contains(found));
  }
  CHECK(seen > 150);
}
