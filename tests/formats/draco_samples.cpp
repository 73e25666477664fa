#include "tests/formats/draco_samples.h"

#include <cmath>
#include <cstdint>

#include <catch2/catch.hpp>
#include <draco/compression/encode.h>

namespace fairway::test {
namespace {

template <class T, std::size_t N>
int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, draco::DataType data_type,
                  bool normalized, const std::vector<std::array<T, N>>& values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<std::uint8_t>(N), data_type, normalized,
                 sizeof(std::array<T, N>), 0);
  const auto count = static_cast<std::uint32_t>(values.size());
  const int id = mesh.AddAttribute(attribute, true, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), values[i].data());
  }
  return id;
}

Bytes bytes_of_buffer(const draco::EncoderBuffer& buffer) {
  const auto* data = reinterpret_cast<const std::byte*>(buffer.data());
  return {data, data + buffer.size()};
}

}  // namespace

Bytes draco_cube(const DracoSampleOptions& options) {
  draco::Mesh mesh;
  const auto indices = cube_indices();
  mesh.SetNumFaces(indices.size() / 3);
  for (std::uint32_t f = 0; f < indices.size() / 3; ++f) {
    mesh.SetFace(draco::FaceIndex(f),
                 {draco::PointIndex(indices[3 * f]), draco::PointIndex(indices[3 * f + 1]),
                  draco::PointIndex(indices[3 * f + 2])});
  }
  mesh.set_num_points(8);
  const auto corners = cube_corners();
  add_attribute(mesh, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, false, corners);
  if (options.normals) {
    auto normals = corners;
    for (auto& n : normals) {
      for (float& v : n) v /= std::sqrt(3.0F);
    }
    add_attribute(mesh, draco::GeometryAttribute::NORMAL, draco::DT_FLOAT32, false, normals);
  }
  if (options.texture_coordinates) {
    std::vector<std::array<float, 2>> uv;
    uv.reserve(corners.size());
    for (const auto& c : corners) uv.push_back({c[0] / 4 + 0.5F, c[1] / 4 + 0.5F});
    add_attribute(mesh, draco::GeometryAttribute::TEX_COORD, draco::DT_FLOAT32, false, uv);
  }
  if (options.colors) {
    std::vector<std::array<std::uint8_t, 3>> colors;
    colors.reserve(8);
    for (std::uint8_t i = 0; i < 8; ++i) colors.push_back({i, 100, 200});
    add_attribute(mesh, draco::GeometryAttribute::COLOR, draco::DT_UINT8, true, colors);
  }
  draco::Encoder encoder;
  if (options.integers) {
    std::vector<std::array<std::int32_t, 1>> numbers;
    numbers.reserve(8);
    for (std::int32_t i = 0; i < 8; ++i)
      numbers.push_back({i % 2 == 0 ? INT32_MAX - i : INT32_MIN});
    add_attribute(mesh, draco::GeometryAttribute::GENERIC, draco::DT_INT32, false, numbers);
    encoder.SetAttributePredictionScheme(draco::GeometryAttribute::GENERIC, draco::PREDICTION_NONE);
    encoder.options().SetGlobalBool("use_built_in_attribute_compression", false);
  }
  encoder.SetEncodingMethod(options.edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                                : draco::MESH_SEQUENTIAL_ENCODING);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  draco::EncoderBuffer buffer;
  REQUIRE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  return bytes_of_buffer(buffer);
}

Bytes draco_point_cloud() {
  draco::PointCloud cloud;
  cloud.set_num_points(8);
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  const int id = cloud.AddAttribute(attribute, true, 8);
  const auto corners = cube_corners();
  for (std::uint32_t i = 0; i < 8; ++i) {
    cloud.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), corners[i].data());
  }
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  REQUIRE(encoder.EncodePointCloudToBuffer(cloud, &buffer).ok());
  return bytes_of_buffer(buffer);
}

SampleGlb draco_glb(const DracoSampleOptions& options) {
  SampleGlb sample = empty_sample();
  const std::size_t payload = sample.add_view(draco_cube(options));
  Json& accessors = sample.json["accessors"];
  Json attributes = {{"POSITION", 0}};
  accessors.push_back({{"componentType", 5126},
                       {"count", 8},
                       {"type", "VEC3"},
                       {"min", {-1, -1, -1}},
                       {"max", {1, 1, 1}}});
  const auto add = [&](bool wanted, const char* name, const char* type, int component_type) {
    if (!wanted) return;
    attributes[name] = accessors.size();
    accessors.push_back({{"componentType", component_type}, {"count", 8}, {"type", type}});
  };
  add(options.normals, "NORMAL", "VEC3", 5126);
  add(options.texture_coordinates, "TEXCOORD_0", "VEC2", 5126);
  add(options.colors, "COLOR_0", "VEC3", 5121);
  if (options.colors) accessors.back()["normalized"] = true;
  const std::size_t indices = accessors.size();
  accessors.push_back({{"componentType", 5123}, {"count", 36}, {"type", "SCALAR"}});
  // The unique ids of draco_cube() run like the accessors here.
  sample.add_mesh(Json::array({{{"attributes", attributes},
                                {"indices", indices},
                                {"extensions",
                                 {{"KHR_draco_mesh_compression",
                                   {{"bufferView", payload}, {"attributes", attributes}}}}}}}));
  sample.json["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  sample.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return sample;
}

}  // namespace fairway::test
