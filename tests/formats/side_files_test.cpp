// Files that a glTF names beside itself, given by a resolver.

#include <map>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <sys/mman.h>

#include "tests/formats/sample_glb.h"

namespace fairway::test {
namespace {

const Bytes& png() {
  static const Bytes bytes = text_bytes("\x89PNG\r\n\x1a\n and more");
  return bytes;
}

/// A folder in memory.
struct Folder {
  std::map<std::string, Bytes> files;

  SideFiles provider() const {
    return [this](const std::string& path) -> Result<ByteSpan> {
      const auto found = files.find(path);
      if (found == files.end()) return Error{ErrorCode::io, "There is no such file."};
      return ByteSpan(found->second);
    };
  }
};

/// A cube whose buffer and image are files.
struct Scene {
  Scene() {
    sample.json["buffers"][0]["uri"] = "data/cube%20one.bin";
    sample.json["images"] = Json::array({{{"uri", "a image.png"}, {"name", "skin"}}});
    folder.files = {{"data/cube one.bin", sample.bin}, {"a image.png", png()}};
  }
  Result<std::unique_ptr<Document>> read() {
    text = text_bytes(sample.json.dump());
    return decode(text, Format::gltf, folder.provider());
  }
  Result<Bytes> written(Format format) {
    const auto document = read();
    if (!document) return document.error();
    return (*document)->encode(shifted(**document, Vec3(1, 0, 0)), format);
  }
  SampleGlb sample = cube_sample();
  Folder folder;
  Bytes text;
};

Json json_of(const Bytes& bytes) {
  return Json::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace

TEST_CASE("a relative URI is the path it means, and nothing else is a path") {
  CHECK(*path_of_uri("a.bin") == "a.bin");
  CHECK(*path_of_uri("b/c/a%20b%2e.bin") == "b/c/a b..bin");
  CHECK(*path_of_uri("two  spaces.png") == "two  spaces.png");
  CHECK(*path_of_uri("%C3%A4.png") == "\xC3\xA4.png");
  for (const char* uri : {"",     "/a",     "//host/a",  "a//b",     "a/",       ".",      "./a",
                          "..",   "../a",   "a/../../b", "%2e%2e/a", "a/%2E%2E", "%2Fetc", "a%2Fb",
                          "a\\b", "..%5Ca", "a%00b",     "a%0Ab",    "%",        "%4",     "%zz",
                          "a%2",  "http:a", "file:///a", "C:/a",     "c:a",      "a?b",    "a#b"}) {
    CAPTURE(uri);
    REQUIRE_FALSE(path_of_uri(uri));
    CHECK(path_of_uri(uri).error().code == ErrorCode::invalid_mesh);
  }
  CHECK_FALSE(path_of_uri(std::string(1025, 'a')));
}

TEST_CASE("a glTF with side files becomes a glTF without any") {
  Scene scene;
  const auto bytes = scene.written(Format::gltf);
  REQUIRE(bytes);
  const Json json = json_of(*bytes);
  CHECK(data_uri_bytes(json["buffers"][0]["uri"]) == scene.sample.bin);
  const std::string image = json["images"][0]["uri"];
  CHECK(image.rfind("data:image/png;base64,", 0) == 0);
  CHECK(data_uri_bytes(image) == png());
  CHECK(json["images"][0]["name"] == "skin");
  CHECK(decode(*bytes, Format::gltf));
}

TEST_CASE("in a GLB the first side buffer is BIN and images are views of it") {
  Scene scene;
  const auto bytes = scene.written(Format::glb);
  REQUIRE(bytes);
  const SampleGlb after = parse_sample(*bytes);
  CHECK_FALSE(after.json["buffers"][0].contains("uri"));
  CHECK(after.json["buffers"].size() == 1);
  const Json& image = after.json["images"][0];
  CHECK_FALSE(image.contains("uri"));
  CHECK(image["mimeType"] == "image/png");
  const Json& view = after.json["bufferViews"][image["bufferView"].get<std::size_t>()];
  const auto first = after.bin.begin() + view["byteOffset"].get<std::ptrdiff_t>();
  CHECK(Bytes(first, first + view["byteLength"].get<std::ptrdiff_t>()) == png());
  CHECK(floats_of(after, after.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"])[0] ==
        0.0F);
}

TEST_CASE("a second side buffer is embedded as it is") {
  Scene scene;
  scene.sample.json["buffers"].push_back({{"uri", "more.bin"}, {"byteLength", 5}});
  scene.folder.files["more.bin"] = text_bytes("12345 and a rest");
  for (const Format format : {Format::gltf, Format::glb}) {
    const auto bytes = scene.written(format);
    REQUIRE(bytes);
    const Json json = format == Format::glb ? parse_sample(*bytes).json : json_of(*bytes);
    CHECK(data_uri_bytes(json["buffers"][1]["uri"]) == text_bytes("12345"));
  }
}

TEST_CASE("a buffer whose file is absent, short or elsewhere is refused with its pointer") {
  const auto check = [](Scene& scene, ErrorCode code, const char* pointer) {
    const auto document = scene.read();
    REQUIRE_FALSE(document);
    CHECK(document.error().code == code);
    CHECK(document.error().pointer == pointer);
  };
  Scene scene;
  scene.sample.json["buffers"][0]["uri"] = "../cube.bin";
  check(scene, ErrorCode::invalid_mesh, "/buffers/0/uri");
  scene.sample.json["buffers"][0]["uri"] = "absent.bin";
  check(scene, ErrorCode::io, "/buffers/0/uri");
  scene.folder.files["absent.bin"] = Bytes(7);
  check(scene, ErrorCode::invalid_mesh, "/buffers/0/byteLength");
}

TEST_CASE("an image that cannot be read stays the reference it is, with a note") {
  const auto* uri = GENERATE("absent.png", "../secret.png", "http://127.0.0.1:1/a.png", "/etc/x");
  Scene scene;
  scene.sample.json["images"][0]["uri"] = uri;
  const auto document = scene.read();
  REQUIRE(document);
  REQUIRE((*document)->notes().size() == 1);
  CHECK((*document)->notes()[0].find("images/0") != std::string::npos);
  const auto bytes = (*document)->encode(unmoved(**document), Format::glb);
  REQUIRE(bytes);
  CHECK(parse_sample(*bytes).json["images"][0]["uri"] == uri);
}

TEST_CASE("a fallback buffer needs no file") {
  Scene scene;
  scene.sample.json["buffers"].push_back(
      {{"uri", "absent.bin"},
       {"byteLength", 96},
       {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  CHECK(scene.read());
  CHECK(decode(scene.sample.gltf(), Format::gltf));
}

TEST_CASE("side files of more than 1 GiB together are too large") {
  constexpr std::size_t kSize = std::size_t{400} << 20;
  void* pages =
      ::mmap(nullptr, kSize, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  REQUIRE(pages != MAP_FAILED);
  SampleGlb sample = cube_sample();
  sample.json["images"] = Json::array();
  for (int i = 0; i < 3; ++i) sample.json["images"].push_back({{"uri", fmt::format("{}.png", i)}});
  const ByteSpan big(static_cast<const std::byte*>(pages), kSize);
  const auto give = [big](const std::string&) -> Result<ByteSpan> { return big; };
  const Bytes glb = sample.glb();
  const auto document = decode(glb, Format::glb, give);
  REQUIRE_FALSE(document);
  CHECK(document.error().code == ErrorCode::too_large);
  ::munmap(pages, kSize);
}

}  // namespace fairway::test
