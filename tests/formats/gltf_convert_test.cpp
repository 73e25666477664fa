// Between the two containers of glTF, and where the appended bytes go.

#include <catch2/catch.hpp>

#include "proto/formats/document.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

struct Output {
  Bytes bytes;
  Json json;
};

Output encoded_gltf(const Document& document, const std::vector<SurfaceResult>& results) {
  auto out = document.encode(results, Format::gltf);
  if (!out) FAIL(out.error().message);
  return {*out, Json::parse(reinterpret_cast<const char*>(out->data()),
                            reinterpret_cast<const char*>(out->data()) + out->size())};
}

Vec3 corner_six(const Bytes& bytes, Format format) {
  return decoded(bytes, format)->surfaces()[0].mesh.positions[6];
}

}  // namespace

TEST_CASE("glTF gets a new buffer and keeps the text of the old one") {
  const SampleGlb sample = cube_sample();
  const Bytes before = sample.gltf();
  const auto document = decoded(before, Format::gltf);
  const Output out = encoded_gltf(*document, shifted(*document, Vec3(1, 0, 0)));
  const Json old = Json::parse(reinterpret_cast<const char*>(before.data()),
                               reinterpret_cast<const char*>(before.data()) + before.size());
  REQUIRE(out.json["buffers"].size() == 2);
  CHECK(out.json["buffers"][0].dump() == old["buffers"][0].dump());
  CHECK(out.json["bufferViews"].back()["buffer"] == 1);
  CHECK(corner_six(out.bytes, Format::gltf) == Vec3(2, 1, 1));
}

TEST_CASE("BIN becomes a data URI on the way from GLB to glTF") {
  const SampleGlb sample = cube_sample();
  const auto document = decoded(sample.glb());
  const Output same = encoded_gltf(*document, unmoved(*document));
  CHECK(data_uri_bytes(same.json["buffers"][0]["uri"]) == sample.bin);
  const Output moved = encoded_gltf(*document, shifted(*document, Vec3(1, 0, 0)));
  const Bytes data = data_uri_bytes(moved.json["buffers"][0]["uri"]);
  CHECK(moved.json["buffers"].size() == 1);
  CHECK(moved.json["buffers"][0]["byteLength"] == data.size());
  REQUIRE(data.size() > sample.bin.size());
  CHECK(Bytes(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(sample.bin.size())) ==
        sample.bin);
  CHECK(corner_six(moved.bytes, Format::gltf) == Vec3(2, 1, 1));
}

TEST_CASE("the first data URI becomes BIN on the way from glTF to GLB") {
  const SampleGlb sample = cube_sample();
  const auto document = decoded(sample.gltf(), Format::gltf);
  const auto same = document->encode(unmoved(*document), Format::glb);
  REQUIRE(same);
  CHECK(parse_sample(*same).json.dump() == sample.json.dump());
  CHECK(parse_sample(*same).bin == sample.bin);
  const auto moved = document->encode(shifted(*document, Vec3(1, 0, 0)), Format::glb);
  REQUIRE(moved);
  const SampleGlb after = parse_sample(*moved);
  CHECK_FALSE(after.json["buffers"][0].contains("uri"));
  CHECK(after.json["buffers"].size() == 1);
  CHECK(corner_six(*moved, Format::glb) == Vec3(2, 1, 1));
}

TEST_CASE("a GLB without BIN chunk gets its new bytes in a data URI") {
  SampleGlb sample = cube_sample();
  const Bytes text = sample.gltf();
  sample.json = Json::parse(reinterpret_cast<const char*>(text.data()),
                            reinterpret_cast<const char*>(text.data()) + text.size());
  sample.bin.clear();
  const auto document = decoded(sample.glb());
  const auto out = document->encode(shifted(*document, Vec3(1, 0, 0)), Format::glb);
  REQUIRE(out);
  const SampleGlb after = parse_sample(*out);
  CHECK(after.bin.empty());
  CHECK(after.json["buffers"][0].dump() == sample.json["buffers"][0].dump());
  CHECK(after.json["buffers"].size() == 2);
  CHECK(corner_six(*out, Format::glb) == Vec3(2, 1, 1));
}

TEST_CASE("data URIs that are cut, short or broken are refused") {
  const SampleGlb sample = cube_sample();
  const std::string text(reinterpret_cast<const char*>(sample.gltf().data()), sample.gltf().size());
  Json json = Json::parse(text);
  const auto uri = json["buffers"][0]["uri"].get<std::string>();
  for (const std::string& broken :
       {uri.substr(0, uri.size() - 1), uri.substr(0, uri.size() - 4), uri + "=", uri + "*AAA",
        std::string("data:;base64,"), std::string("data:;base64")}) {
    json["buffers"][0]["uri"] = broken;
    const auto document = decode(text_bytes(json.dump()), Format::gltf);
    REQUIRE_FALSE(document);
    CHECK(document.error().code == ErrorCode::invalid_mesh);
  }
  json["buffers"][0].erase("uri");
  CHECK_FALSE(decode(text_bytes(json.dump()), Format::gltf));
}

TEST_CASE("appended bytes start behind the old ones at a multiple of four") {
  SampleGlb sample = cube_sample();
  const std::vector<std::byte> odd(5, std::byte{0xAB});
  sample.add_view(odd);
  REQUIRE(sample.bin.size() % 4 == 1);
  const auto document =
      GENERATE(true, false) ? decoded(sample.glb()) : decoded(sample.gltf(), Format::gltf);
  const auto out = document->encode(shifted(*document, Vec3(1, 0, 0)), Format::glb);
  REQUIRE(out);
  CHECK(corner_six(*out, Format::glb) == Vec3(2, 1, 1));
  const SampleGlb after = parse_sample(*out);
  CHECK(after.json["bufferViews"].back()["byteOffset"].get<std::size_t>() % 4 == 0);
  CHECK(Bytes(after.bin.begin(),
              after.bin.begin() + static_cast<std::ptrdiff_t>(sample.bin.size())) == sample.bin);
}
