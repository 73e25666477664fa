// Seeds of glTF scenes: what the readers have a branch for.

#include "proto/formats/fresh_mesh.h"
#include "tests/formats/draco_samples.h"
#include "tests/formats/meshopt_samples.h"
#include "tests/fuzz/seeds.h"

namespace fairway::test {
namespace {

Json& primitive_of(SampleGlb& sample) {
  return sample.json["meshes"][0]["primitives"][0];
}

template <class T>
std::vector<T> narrow(const std::vector<std::uint32_t>& values) {
  std::vector<T> out;
  out.reserve(values.size());
  for (const std::uint32_t value : values) out.push_back(static_cast<T>(value));
  return out;
}

SampleGlb with_normals() {
  SampleGlb sample = cube_sample();
  std::vector<std::array<float, 3>> normals;
  for (const auto& c : cube_corners()) {
    normals.push_back({c[0] * 0.57735026F, c[1] * 0.57735026F, c[2] * 0.57735026F});
  }
  primitive_of(sample)["attributes"]["NORMAL"] = sample.add_vec3(normals);
  std::vector<float> tangents;
  for (int i = 0; i < 8; ++i) tangents.insert(tangents.end(), {1, 0, 0, 1});
  const std::size_t view = sample.add_view(bytes_of(tangents));
  primitive_of(sample)["attributes"]["TANGENT"] = sample.add_accessor(view, 5126, "VEC4", 8);
  return sample;
}

/// Positions as normalized 16-bit integers, four apart, and 8-bit indices.
SampleGlb quantized() {
  SampleGlb sample = empty_sample();
  std::vector<std::int16_t> corners;
  for (const auto& c : cube_corners()) {
    for (const float v : c) corners.push_back(static_cast<std::int16_t>(v * 32767));
    corners.push_back(0);
  }
  const std::size_t view = sample.add_view(bytes_of(corners), 8);
  const std::size_t position = sample.add_accessor(view, 5122, "VEC3", 8);
  Json& accessor = sample.json["accessors"][position];
  accessor["normalized"] = true;
  accessor["min"] = {-32767, -32767, -32767};
  accessor["max"] = {32767, 32767, 32767};
  const std::size_t index_view = sample.add_view(bytes_of(narrow<std::uint8_t>(cube_indices())));
  const std::size_t indices = sample.add_accessor(index_view, 5121, "SCALAR", 36);
  sample.add_mesh(Json::array({{{"attributes", {{"POSITION", position}}}, {"indices", indices}}}));
  sample.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  sample.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  return sample;
}

/// Colours as normalized bytes, texture coordinates as normalized shorts.
SampleGlb with_extras() {
  SampleGlb sample = cube_sample();
  const auto add = [&](const char* name, std::size_t view, unsigned type, const char* shape) {
    const std::size_t accessor = sample.add_accessor(view, type, shape, 8);
    sample.json["accessors"][accessor]["normalized"] = true;
    primitive_of(sample)["attributes"][name] = accessor;
  };
  std::vector<std::uint8_t> bytes;
  bytes.reserve(32);
  for (int i = 0; i < 32; ++i) bytes.push_back(static_cast<std::uint8_t>(8 * i));
  add("COLOR_0", sample.add_view(bytes_of(bytes)), 5121, "VEC4");
  add("TEXCOORD_0", sample.add_view(bytes_of(std::vector<std::uint16_t>(16, 4000))), 5123, "VEC2");
  return sample;
}

SampleGlb sparse() {
  SampleGlb sample = cube_sample();
  const std::size_t indices = sample.add_view(bytes_of(std::vector<std::uint16_t>{1, 6}));
  const std::size_t values = sample.add_view(bytes_of(std::vector<float>{1, -1, -2, 1, 1, 2}));
  Json& accessor = sample.json["accessors"][0];
  accessor["min"] = {-1, -1, -2};
  accessor["max"] = {1, 1, 2};
  accessor["sparse"] = {{"count", 2},
                        {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                        {"values", {{"bufferView", values}}}};
  return sample;
}

/// A strip, a fan and lists over the same positions, and a second mesh that shares them.
SampleGlb many_primitives() {
  SampleGlb sample = cube_sample();
  const Json attributes = primitive_of(sample)["attributes"];
  const std::size_t strip = sample.add_indices({0, 1, 3, 2, 7, 6, 4, 5});
  const std::size_t fan = sample.add_indices({0, 1, 2, 3, 7, 4});
  Json& primitives = sample.json["meshes"][0]["primitives"];
  primitives.push_back({{"attributes", attributes}, {"indices", strip}, {"mode", 5}});
  primitives.push_back({{"attributes", attributes}, {"indices", fan}, {"mode", 6}});
  primitives.push_back({{"attributes", attributes}, {"mode", 5}});
  primitives.push_back({{"attributes", attributes}, {"mode", 0}});
  sample.add_mesh(Json::array({{{"attributes", attributes}, {"indices", strip}, {"mode", 5}}}));
  sample.json["nodes"][0]["children"] = {1};
  sample.json["nodes"].push_back({{"mesh", 1}, {"translation", {0, 0, 3}}, {"scale", {2, 1, 1}}});
  return sample;
}

/// Morph targets, a skin, an animation, a material with a texture in the BIN chunk, extras.
SampleGlb furnished() {
  SampleGlb sample = with_normals();
  const std::size_t target = sample.add_vec3(cube_corners());
  primitive_of(sample)["targets"] = {{{"POSITION", target}}};
  sample.json["meshes"][0]["weights"] = {0.5};
  const std::size_t image = sample.add_view(text_bytes("\x89PNG\r\n\x1a\n...."));
  sample.json["images"] = {{{"bufferView", image}, {"mimeType", "image/png"}}};
  sample.json["textures"] = {{{"source", 0}}};
  sample.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  primitive_of(sample)["material"] = 0;
  std::vector<std::uint8_t> joints(32, 0);
  std::vector<float> weights;
  for (int i = 0; i < 8; ++i) weights.insert(weights.end(), {1, 0, 0, 0});
  const std::size_t joint_view = sample.add_view(bytes_of(joints));
  primitive_of(sample)["attributes"]["JOINTS_0"] = sample.add_accessor(joint_view, 5121, "VEC4", 8);
  const std::size_t weight_view = sample.add_view(bytes_of(weights));
  primitive_of(sample)["attributes"]["WEIGHTS_0"] =
      sample.add_accessor(weight_view, 5126, "VEC4", 8);
  sample.json["skins"] = {{{"joints", {0}}}};
  sample.json["nodes"][0]["skin"] = 0;
  sample.json["extras"] = {{"kept", {1, 2.5, "three", nullptr}}};
  return sample;
}

/// Positions of an accessor without a view are zeros, but for the sparse ones.
SampleGlb without_view() {
  SampleGlb sample = sparse();
  sample.json["accessors"][0].erase("bufferView");
  sample.json["accessors"][0].erase("byteOffset");
  return sample;
}

/// A past finding: the first view is a new key of the document, which moves all that is in it.
SampleGlb without_any_view() {
  SampleGlb sample = empty_sample();
  sample.json["accessors"] = {{{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}};
  sample.add_mesh(Json::array({{{"attributes", {{"POSITION", 0}}}}}));
  return sample;
}

std::vector<std::pair<std::string, SampleGlb>> scenes() {
  return {{"cube", cube_sample()},
          {"normals", with_normals()},
          {"quantized", quantized()},
          {"sparse", sparse()},
          {"extras", with_extras()},
          {"many", many_primitives()},
          {"furnished", furnished()},
          {"no_view", without_view()},
          {"no_view_at_all", without_any_view()}};
}

/// What our own writer makes of a sample: positions moved, attributes added.
Bytes rewritten(const SampleGlb& sample, Format format) {
  const Decoded document = decoded(sample.glb());
  auto results = shifted(*document, Vec3(0.25, 0, 0));
  add_ramp(*document, "_CURVATURE_K1", 1, results);
  add_ramp(*document, "_CURVATURE_DIR1", 3, results);
  const auto bytes = convert(*document, results, Format::glb, format);
  return bytes ? *bytes : Bytes();
}

}  // namespace

std::vector<Seed> glb_seeds() {
  std::vector<Seed> out;
  for (const auto& [name, sample] : scenes()) {
    out.push_back({name, sample.glb()});
    out.push_back({name + "_rewritten", rewritten(sample, Format::glb)});
  }
  for (Seed& seed : shape_seeds(Format::glb)) out.push_back(std::move(seed));
  return out;
}

std::vector<Seed> meshopt_seeds() {
  const SampleGlb cube = meshopt_cube();
  std::vector<Seed> out = {{"ext", cube.glb()},
                           {"khr", meshopt_cube("KHR_meshopt_compression").glb()},
                           {"rewritten", rewritten(cube, Format::glb)}};
  SampleGlb sequence = meshopt_cube();
  const Bytes stream = meshopt_sequence(cube_indices());
  Json& layout = sequence.json["bufferViews"][1]["extensions"]["EXT_meshopt_compression"];
  layout["mode"] = "INDICES";
  layout["byteOffset"] = sequence.bin.size();
  layout["byteLength"] = stream.size();
  sequence.bin.insert(sequence.bin.end(), stream.begin(), stream.end());
  sequence.bin.resize((sequence.bin.size() + 3) / 4 * 4);
  sequence.json["buffers"][0]["byteLength"] = sequence.bin.size();
  out.push_back({"sequence", sequence.glb()});
  for (const char* filter : {"EXPONENTIAL", "NONE"}) {
    SampleGlb filtered = meshopt_cube();
    filtered.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["filter"] = filter;
    out.push_back({filter, filtered.glb()});
  }
  return out;
}

std::vector<Seed> draco_glb_seeds() {
  std::vector<Seed> out;
  for (const bool edgebreaker : {false, true}) {
    const std::string name = edgebreaker ? "edgebreaker" : "sequential";
    const SampleGlb plain = draco_glb({.edgebreaker = edgebreaker});
    out.push_back({name, plain.glb()});
    out.push_back({name + "_rewritten", rewritten(plain, Format::glb)});
    out.push_back({name + "_all", draco_glb({edgebreaker, true, true, true}).glb()});
  }
  return out;
}

std::vector<Seed> gltf_seeds() {
  std::vector<Seed> out;
  for (const auto& [name, sample] : scenes()) out.push_back({name, sample.gltf()});
  out.push_back({"meshopt", rewritten(meshopt_cube(), Format::gltf)});
  out.push_back({"draco", draco_glb({.normals = true}).gltf()});
  // What the target's provider holds: 8 corners and 4 triangles.
  SampleGlb beside = empty_sample();
  beside.json["buffers"] = {{{"byteLength", 144}, {"uri", "side.bin"}}};
  beside.json["bufferViews"] = {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 96}},
                                {{"buffer", 0}, {"byteOffset", 96}, {"byteLength", 48}}};
  beside.add_accessor(0, 5126, "VEC3", 8);
  beside.add_accessor(1, 5125, "SCALAR", 12);
  beside.json["accessors"][0]["min"] = {0, 0, 0};
  beside.json["accessors"][0]["max"] = {1, 1, 1};
  beside.add_mesh(Json::array({{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}));
  beside.json["images"] = {{{"uri", "a%20folder/image.png"}}};
  out.push_back({"side_file", text_bytes(beside.json.dump())});
  return out;
}

}  // namespace fairway::test
