#include "tests/formats/sample_glb.h"

#include <cstring>

#include <catch2/catch.hpp>

namespace fairway::test {
namespace {

void add_u32(Bytes& out, std::uint32_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8) out.push_back(std::byte(value >> shift & 0xFFU));
}

std::uint32_t u32_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  REQUIRE(at + 4 <= bytes.size());
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

std::string base64(const Bytes& bytes) {
  static constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  unsigned bits = 0;
  int have = 0;
  for (const std::byte b : bytes) {
    bits = bits << 8U | std::to_integer<unsigned>(b);
    for (have += 8; have >= 6; have -= 6) out += kDigits[bits >> (have - 6) & 0x3FU];
  }
  if (have > 0) out += kDigits[bits << (6 - have) & 0x3FU];
  while (out.size() % 4 != 0) out += '=';
  return out;
}

}  // namespace

std::size_t SampleGlb::add_view(std::span<const std::byte> bytes, std::size_t stride) {
  bin.resize((bin.size() + 3) / 4 * 4);
  Json view = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  bin.insert(bin.end(), bytes.begin(), bytes.end());
  json["bufferViews"].push_back(view);
  json["buffers"][0]["byteLength"] = bin.size();
  return json["bufferViews"].size() - 1;
}

std::size_t SampleGlb::add_accessor(std::size_t view, unsigned component_type, std::string type,
                                    std::size_t count, std::size_t offset) {
  Json accessor = {{"bufferView", view},
                   {"byteOffset", offset},
                   {"componentType", component_type},
                   {"count", count},
                   {"type", type}};
  json["accessors"].push_back(accessor);
  return json["accessors"].size() - 1;
}

std::size_t SampleGlb::add_vec3(const std::vector<std::array<float, 3>>& values) {
  const std::size_t accessor =
      add_accessor(add_view(bytes_of(values)), 5126, "VEC3", values.size());
  std::array<float, 3> low = values.front();
  std::array<float, 3> high = values.front();
  for (const auto& value : values) {
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], value[c]);
      high[c] = std::max(high[c], value[c]);
    }
  }
  json["accessors"][accessor]["min"] = low;
  json["accessors"][accessor]["max"] = high;
  return accessor;
}

std::size_t SampleGlb::add_indices(const std::vector<std::uint32_t>& indices) {
  return add_accessor(add_view(bytes_of(indices)), 5125, "SCALAR", indices.size());
}

std::size_t SampleGlb::add_mesh(Json primitives) {
  json["meshes"].push_back({{"primitives", std::move(primitives)}});
  return json["meshes"].size() - 1;
}

Bytes SampleGlb::glb() const {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  Bytes padded = bin;
  padded.resize((bin.size() + 3) / 4 * 4);
  Bytes out = text_bytes("glTF");
  const std::size_t bin_chunk = bin.empty() ? 0 : 8 + padded.size();
  add_u32(out, 2);
  add_u32(out, static_cast<std::uint32_t>(20 + text.size() + bin_chunk));
  add_u32(out, static_cast<std::uint32_t>(text.size()));
  add_u32(out, 0x4E4F534A);
  for (const char c : text) out.push_back(std::byte(c));
  if (!bin.empty()) {
    add_u32(out, static_cast<std::uint32_t>(padded.size()));
    add_u32(out, 0x004E4942);
    out.insert(out.end(), padded.begin(), padded.end());
  }
  return out;
}

Bytes SampleGlb::gltf() const {
  Json copy = json;
  copy["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(bin);
  return text_bytes(copy.dump());
}

SampleGlb empty_sample() {
  SampleGlb sample;
  sample.json = {{"asset", {{"version", "2.0"}, {"generator", "sample"}}},
                 {"scene", 0},
                 {"scenes", {{{"nodes", {0}}}}},
                 {"nodes", {{{"mesh", 0}}}}};
  return sample;
}

std::vector<std::array<float, 3>> cube_corners() {
  return {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
          {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
}

std::vector<std::uint32_t> cube_indices() {
  return {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
          1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};
}

SampleGlb cube_sample() {
  SampleGlb sample = empty_sample();
  const std::size_t position = sample.add_vec3(cube_corners());
  const std::size_t indices = sample.add_indices(cube_indices());
  sample.add_mesh(Json::array({{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}));
  return sample;
}

SampleGlb parse_sample(std::span<const std::byte> glb) {
  SampleGlb sample;
  REQUIRE(u32_at(glb, 0) == 0x46546C67);
  REQUIRE(u32_at(glb, 4) == 2);
  REQUIRE(u32_at(glb, 8) == glb.size());
  const std::size_t text = u32_at(glb, 12);
  REQUIRE(text % 4 == 0);
  const auto* first = reinterpret_cast<const char*>(glb.data()) + 20;
  sample.json = Json::parse(first, first + text);
  if (20 + text < glb.size()) {
    REQUIRE(u32_at(glb, 24 + text) == 0x004E4942);
    const auto bin = glb.subspan(28 + text, u32_at(glb, 20 + text));
    sample.bin.assign(bin.begin(), bin.end());
  }
  return sample;
}

Bytes data_uri_bytes(const std::string& uri) {
  const std::string text = uri.substr(uri.find(',') + 1);
  Bytes out;
  unsigned bits = 0;
  int have = 0;
  for (const char c : text) {
    if (c == '=') break;
    const unsigned digit = c >= 'A' && c <= 'Z'   ? static_cast<unsigned>(c - 'A')
                           : c >= 'a' && c <= 'z' ? static_cast<unsigned>(c - 'a' + 26)
                           : c >= '0' && c <= '9' ? static_cast<unsigned>(c - '0' + 52)
                           : c == '+'             ? 62U
                                                  : 63U;
    bits = bits << 6U | digit;
    have += 6;
    if (have >= 8) {
      have -= 8;
      out.push_back(std::byte(bits >> have & 0xFFU));
    }
  }
  return out;
}

Bytes text_bytes(const std::string& text) {
  const auto* data = reinterpret_cast<const std::byte*>(text.data());
  return {data, data + text.size()};
}

std::vector<SurfaceResult> shifted(const Document& document, const Vec3& by) {
  std::vector<SurfaceResult> results;
  for (const Surface& surface : document.surfaces()) {
    SurfaceResult result;
    result.moved = true;
    for (const Vec3& position : surface.mesh.positions) result.positions.push_back(position + by);
    result.normals = surface.normals;
    results.push_back(result);
  }
  return results;
}

std::vector<SurfaceResult> unmoved(const Document& document) {
  return std::vector<SurfaceResult>(document.surfaces().size());
}

void add_ramp(const Document& document, const std::string& name, int components,
              std::vector<SurfaceResult>& results) {
  for (std::size_t s = 0; s < results.size(); ++s) {
    VertexAttribute attribute{name, components, {}};
    const std::size_t vertices = document.surfaces()[s].mesh.positions.size();
    for (std::size_t i = 0; i < vertices * static_cast<std::size_t>(components); ++i) {
      attribute.values.push_back(static_cast<float>(i));
    }
    results[s].attributes.push_back(attribute);
  }
}

Decoded::Decoded(Bytes bytes, Format format) : bytes_(std::move(bytes)) {
  auto document = decode(bytes_, format);
  if (!document) FAIL(document.error().message);
  document_ = *std::move(document);
}

Decoded decoded(Bytes bytes, Format format) {
  return {std::move(bytes), format};
}

std::vector<float> floats_of(const SampleGlb& sample, std::size_t accessor) {
  const Json& def = sample.json["accessors"][accessor];
  REQUIRE(def["componentType"] == 5126);
  const Json& view = sample.json["bufferViews"][def["bufferView"].get<std::size_t>()];
  REQUIRE(!view.contains("byteStride"));
  REQUIRE(view["buffer"] == 0);
  const std::string type = def["type"];
  const std::size_t components = type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
  std::vector<float> out(def["count"].get<std::size_t>() * components);
  const std::size_t offset = view["byteOffset"].get<std::size_t>() + def.value("byteOffset", 0U);
  REQUIRE(offset + out.size() * 4 <= sample.bin.size());
  std::memcpy(out.data(), sample.bin.data() + offset, out.size() * 4);
  return out;
}

}  // namespace fairway::test
