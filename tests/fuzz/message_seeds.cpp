// Seeds of documents and requests.

#include "proto/messages/worker_protocol.h"
#include "tests/formats/draco_samples.h"
#include "tests/fuzz/seeds.h"

namespace fairway::test {
namespace {

constexpr std::array<const char*, 8> kParameters = {
    "",
    "{}",
    R"({"steps":"auto","step_size":"auto","lambda":"auto"})",
    R"({"method":"anisotropic","integration":"semi_implicit","mass":"lumped",
        "curvature_measure":"project","steps":50,"step_size":0.05,"feature_angle":35,
        "transition":8,"curvature_smoothing":{"passes":3,"fraction":0.5},"boundary":"fixed",
        "conventions":"paper","guards":{"unfold":false,"min_component":false,"local_step":false},
        "fixed_vertices":[3,1,4,1],"curvature":["mean","_CURVATURE_K1"],"features":true,
        "output":"gltf"})",
    R"({"fixed_vertices":[{"mesh":0,"primitive":1,"vertices":[0,1]},
        {"mesh":2,"primitive":0,"vertices":[2147483647]}]})",
    R"({"meshes":[0,2],"nodes":[1],"weld":"none","curvature_space":"world",
        "colors":{"limit":2.5,"replace":true}})",
    R"({"steps":2.5})",
    R"({"unknown":"\u00e4","a/b~c":[[[]]]})"};

}  // namespace

std::vector<Seed> recognition_seeds() {
  std::vector<Seed> out;
  const auto add = [&out](const std::string& declared, const std::vector<Seed>& from) {
    const Seed& seed = from.front();
    Bytes bytes = text_bytes(declared + "\n");
    const std::size_t head = std::min(seed.bytes.size(), kMagicBytes);
    bytes.insert(bytes.end(), seed.bytes.begin(), seed.bytes.begin() + static_cast<long>(head));
    out.push_back({"seed_" + std::to_string(out.size()), std::move(bytes)});
  };
  add("model/gltf-binary;", glb_seeds());
  add("model/gltf+json;scene.gltf", gltf_seeds());
  add("application/octet-stream;MESH.DRC", {{"cube", draco_cube()}});
  for (const Format format : {Format::ply, Format::obj, Format::stl}) {
    add(std::string(media_type_of(format)) + ";", shape_seeds(format));
    add(";", shape_seeds(format));
    add(";a." + std::string(name_of(format)), {shape_seeds(format).back()});
  }
  return out;
}

std::vector<Seed> parameter_seeds() {
  std::vector<Seed> out;
  out.reserve(kParameters.size() + 1);
  for (const char* text : kParameters) {
    out.push_back({"seed_" + std::to_string(out.size()), text_bytes(text)});
  }
  out.push_back({"default", text_bytes(dump_json(parameters_document({})))});
  return out;
}

std::vector<Seed> worker_order_seeds() {
  std::vector<Seed> out;
  for (const char* text : kParameters) {
    const auto parameters = parse_parameters(text);
    if (!parameters) continue;
    for (const Format input : {Format::glb, Format::ply}) {
      std::string line = format_line(WorkerOrder{input, *parameters});
      line.pop_back();
      out.push_back({"seed_" + std::to_string(out.size()), text_bytes(line)});
    }
  }
  return out;
}

std::vector<Seed> worker_event_seeds() {
  const std::vector<WorkerEvent> events = {
      Progress{"flow", 3, 50, 0.25}, Finished{Format::glb, {{"surfaces", Json::array()}}},
      Failed{{ErrorCode::invalid_mesh, "The mesh is broken.", "/meshes/0"}}};
  std::vector<Seed> out;
  for (const WorkerEvent& event : events) {
    std::string line = format_line(event);
    line.pop_back();
    out.push_back({"seed_" + std::to_string(out.size()), text_bytes(line)});
  }
  return out;
}

std::vector<Seed> http_seeds() {
  const std::string post = "POST /v1/jobs?params=%7B%7D HTTP/1.1\r\nHost: t\r\n";
  const std::vector<std::string> texts = {
      "GET /livez HTTP/1.1\r\nHost: t\r\nRange: bytes=0-1\r\nAccept-Encoding: gzip\r\n\r\n",
      "\r\nGET / HTTP/1.0\r\nConnection: close\r\n\r\nGET / HTTP/1.1\r\n\r\n",
      post + "Content-Length: 5\r\nExpect: 100-continue\r\n\r\nhelloGET / HTTP/1.1\r\n\r\n",
      post + "Transfer-Encoding: chunked\r\n\r\n5;a=b\r\nhello\r\n1f\r\n" + std::string(31, 'x') +
          "\r\n0\r\nTrailer: x\r\n\r\nGET / HTTP/1.1\r\n\r\n",
      post + "Content-Length: 99999999999999999999999\r\nContent-Encoding: gzip\r\n\r\nx",
      post +
          "Content-Type: multipart/form-data; boundary=b\r\nContent-Length: 70\r\n\r\n"
          "--b\r\nContent-Disposition: form-data; name=\"mesh\"\r\n\r\nsolid\r\n--b--\r\n"};
  std::vector<Seed> out;
  out.reserve(texts.size());
  for (const std::string& text : texts) {
    out.push_back({"seed_" + std::to_string(out.size()), text_bytes(text)});
  }
  return out;
}

std::vector<Seed> multipart_seeds() {
  const std::string named = "--B\r\nContent-Disposition: form-data; name=\"mesh\"";
  const std::vector<std::string> texts = {
      named + "\r\n\r\nsolid\r\n--B--\r\n",
      named +
          "; filename=\"a \\\"b\\\".glb\"\r\nContent-Type: model/gltf-binary\r\n\r\n\r\n--\r\n--A"
          "\r\n" +
          named + "\r\n\r\n\r\n--B--\r\n",
      "\r\n--B\r\ncontent-disposition:form-data;name=params\r\nX: y\r\n\r\n{}\r\n--B--epilogue"};
  std::vector<Seed> out;
  for (const std::string& text : texts) {
    out.push_back({"seed_" + std::to_string(out.size()), text_bytes(text)});
  }
  return out;
}

}  // namespace fairway::test
