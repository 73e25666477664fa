// The parameter document.

#include "proto/messages/parameters.h"

#include <string>

#include <catch2/catch.hpp>

namespace fairway::test {
namespace {

Parameters good(const std::string& text) {
  INFO(text);
  const Result<Parameters> parameters = parse_parameters(text);
  REQUIRE(parameters);
  return *parameters;
}

void check_refused(const std::string& text, ErrorCode code, const std::string& pointer) {
  INFO(text);
  const Result<Parameters> parameters = parse_parameters(text);
  REQUIRE_FALSE(parameters);
  CHECK(parameters.error().code == code);
  CHECK(parameters.error().pointer == pointer);
  CHECK(parameters.error().message.size() > 10);
}

}  // namespace

TEST_CASE("nothing and {} mean the automatic variational method") {
  for (const char* text : {"", "{}", R"({"steps":"auto","step_size":"auto","lambda":"auto"})"}) {
    const Parameters p = good(text);
    CHECK(p.flow.method == Method::variational);
    CHECK_FALSE(p.flow.strength);
    CHECK(p.flow.noise == NoiseKind::automatic);
    CHECK(p.flow.surface == SurfaceKind::automatic);
    CHECK_FALSE(p.flow.steps);
    CHECK_FALSE(p.flow.step_size);
    CHECK_FALSE(p.flow.lambda);
    CHECK_FALSE(p.flow.feature_angle);
    CHECK(p.flow.guards.unfold);
    CHECK(p.flow.guards.min_component == 12);
    CHECK(p.flow.guards.local_step);
    CHECK(p.curvature.kinds.size() == 7);
    CHECK(p.fixed_vertices.empty());
    CHECK_FALSE(p.flow.find_features);
    CHECK_FALSE(p.output);
  }
}

TEST_CASE("a parameter of the flows means the paper's flow where no method is stated") {
  for (const char* text :
       {R"({"steps":3})", R"({"step_size":0.1})", R"({"feature_angle":30})", R"({"lambda":0.1})",
        R"({"transition":8})", R"({"mass":"full"})", R"({"integration":"semi_implicit"})",
        R"({"curvature_measure":"length"})", R"({"curvature_smoothing":{"passes":2}})",
        R"({"conventions":"paper"})", R"({"guards":{"unfold":false}})",
        R"({"preset":"cad","steps":3})", R"({"preset":"gentle","steps":3})"}) {
    CAPTURE(text);
    CHECK(good(text).flow.method == Method::anisotropic_prescribed);
    CHECK_FALSE(good(text).flow.strength);
  }
  CHECK(good(R"({"boundary":"fixed"})").flow.method == Method::variational);
  CHECK(good(R"({"features":true})").flow.method == Method::variational);
}

TEST_CASE("the variational method reads its own parameters, and thresholds for marked features") {
  const Parameters p = good(R"({"strength":0.5,"noise":"correlated","surface":"smooth"})");
  CHECK(p.flow.method == Method::variational);
  CHECK(p.flow.strength == 0.5);
  CHECK(p.flow.noise == NoiseKind::correlated);
  CHECK(p.flow.surface == SurfaceKind::smooth);
  CHECK(good(R"({"method":"variational","feature_angle":30})").flow.feature_angle == 30.0);
  check_refused(R"({"strength":1.5})", ErrorCode::invalid_parameters, "/strength");
  check_refused(R"({"noise":"pink"})", ErrorCode::invalid_parameters, "/noise");
  check_refused(R"({"surface":3})", ErrorCode::invalid_parameters, "/surface");
}

TEST_CASE("parameters that the stated method has no use for are refused, and say whose they are") {
  check_refused(R"({"method":"variational","steps":3})", ErrorCode::invalid_parameters, "/steps");
  check_refused(R"({"method":"variational","guards":{}})", ErrorCode::invalid_parameters,
                "/guards");
  check_refused(R"({"method":"anisotropic","strength":0.5})", ErrorCode::invalid_parameters,
                "/strength");
  check_refused(R"({"steps":3,"noise":"white"})", ErrorCode::invalid_parameters, "/noise");
  check_refused(R"({"method":"none","surface":"sharp"})", ErrorCode::invalid_parameters,
                "/surface");
  CHECK(good(R"({"method":"variational","steps":"auto"})").flow.method == Method::variational);
}

TEST_CASE("every parameter is read") {
  const Parameters p =
      good(R"({"method":"anisotropic","integration":"semi_implicit","mass":"lumped",
      "curvature_measure":"project","steps":50,
      "step_size":0.05,"feature_angle":35,"transition":8,
      "curvature_smoothing":{"passes":3,"fraction":0.5},"boundary":"fixed","conventions":"paper",
      "guards":{"unfold":false,"min_component":false,"local_step":false},
      "fixed_vertices":[3,1,4,1],
      "curvature":["mean","_CURVATURE_K1"],"features":true,"output":"gltf"})");
  CHECK(p.flow.method == Method::anisotropic);
  CHECK(p.flow.integration == Integration::semi_implicit);
  CHECK(p.flow.mass == Mass::lumped);
  CHECK(p.flow.measure == CurvatureMeasure::project);
  CHECK(p.flow.steps == 50);
  CHECK(p.flow.step_size == 0.05);
  CHECK(p.flow.feature_angle == 35.0);
  CHECK(p.flow.transition == 8.0);
  CHECK(p.flow.curvature_smoothing.passes == 3);
  CHECK(p.flow.curvature_smoothing.fraction == 0.5);
  CHECK(p.flow.boundary == Boundary::fixed);
  CHECK(p.flow.conventions == Conventions::paper);
  CHECK_FALSE(p.flow.guards.unfold);
  CHECK(p.flow.guards.min_component == 0);
  CHECK_FALSE(p.flow.guards.local_step);
  CHECK(p.curvature.kinds == std::vector{CurvatureKind::k1, CurvatureKind::mean});
  CHECK(p.flow.find_features);
  REQUIRE(p.fixed_vertices.size() == 1);
  CHECK_FALSE(p.fixed_vertices[0].place);
  CHECK(p.fixed_vertices[0].vertices == std::vector<Index>{3, 1, 4, 1});
  CHECK(p.output == Format::gltf);
  CHECK(good(R"({"output":{"format":"glb"}})").output == Format::glb);
  CHECK(good(R"({"output":"ply"})").output == Format::ply);
  CHECK(good(R"({"output":"obj"})").output == Format::obj);
  CHECK(good(R"({"output":"stl"})").output == Format::stl);
}

TEST_CASE("a parameter document survives the round trip") {
  const auto* text = GENERATE("{}", R"({"lambda":0.25,"steps":7,"curvature":[]})",
                              R"({"method":"none","feature_angle":20.5,"output":"glb"})",
                              R"({"fixed_vertices":[0,2147483647],"features":true})",
                              R"({"meshes":[2,0],"nodes":[7],"weld":"none"})",
                              R"({"curvature_space":"world","colors":true})",
                              R"({"colors":{"limit":2.5,"replace":true}})",
                              R"({"fixed_vertices":[{"mesh":2,"vertices":[5]},
                                  {"vertices":[],"primitive":1,"mesh":0}]})");
  const Json document = parameters_document(good(text));
  CHECK(parameters_document(good(dump_json(document))) == document);
}

TEST_CASE("what is not JSON is malformed, what is no object invalid") {
  for (const char* text :
       {"{", "{\"steps\":NaN}", "{\"steps\":Infinity}", "{} x", "{\"a\":1,\"a\":2}"}) {
    check_refused(text, ErrorCode::malformed_parameters, "");
  }
  for (const char* text : {"null", "[]", "\"steps\"", "3"}) {
    check_refused(text, ErrorCode::invalid_parameters, "");
  }
}

TEST_CASE("wrong types, ranges and unknown keys are refused with the pointer of the culprit") {
  const auto refused = [](const std::string& text, const std::string& pointer) {
    check_refused(text, ErrorCode::invalid_parameters, pointer);
  };
  for (const char* value :
       {"-1", "1000000000", "2147483648", "1.5", "true", "null", "\"5\"", "[]"}) {
    refused(std::string(R"({"steps":)") + value + "}", "/steps");
  }
  for (const char* value : {"-0.5", "0", "\"0.5\"", "1e308", "null"}) {
    refused(std::string(R"({"step_size":)") + value + "}", "/step_size");
  }
  refused(R"({"lambda":-0.5})", "/lambda");
  refused(R"({"feature_angle":-1})", "/feature_angle");
  refused(R"({"feature_angle":181})", "/feature_angle");
  refused(R"({"method":"magic"})", "/method");
  refused(R"({"stepz":3})", "/stepz");
  refused(R"({"guards":{"unfolded":true}})", "/guards/unfolded");
  refused(R"({"guards":{"local_step":1}})", "/guards/local_step");
  refused(R"({"guards":3})", "/guards");
  refused(R"({"curvature_smoothing":{"fraction":1.5}})", "/curvature_smoothing/fraction");
  refused(R"({"curvature":["k1","k3"]})", "/curvature/1");
  refused(R"({"curvature":["k1","k1"]})", "/curvature/1");
  refused(R"({"output":"exe"})", "/output");
  refused(R"({"output":{"format":"exe"}})", "/output/format");
  refused(R"({"a/b~c":1})", "/a~1b~0c");
}

TEST_CASE("fixed vertices may be named by mesh and primitive") {
  const Parameters p = good(R"({"fixed_vertices":[{"mesh":2,"primitive":1,"vertices":[7,0]},
                                                  {"mesh":0,"vertices":[1]}]})");
  REQUIRE(p.fixed_vertices.size() == 2);
  CHECK(p.fixed_vertices[0].place->mesh == 2);
  CHECK(p.fixed_vertices[0].place->primitive == 1);
  CHECK(p.fixed_vertices[0].vertices == std::vector<Index>{7, 0});
  CHECK(p.fixed_vertices[1].place->primitive == 0);
}

TEST_CASE("lists of fixed vertices that are none are refused with the pointer of the culprit") {
  const auto refused = [](const std::string& value, const std::string& rest) {
    check_refused(R"({"fixed_vertices":)" + value + "}", ErrorCode::invalid_parameters,
                  "/fixed_vertices" + rest);
  };
  for (const char* value : {"3", "null", "{}", "\"all\"", "true"}) refused(value, "");
  for (const char* item : {"-1", "1.5", "\"2\"", "null", "[2]", "2147483648", "{}"}) {
    refused(std::string("[0,") + item + "]", "/1");
  }
  refused(R"([{"mesh":0,"vertices":[1]},3])", "/1");
  refused(R"([{"vertices":[1]}])", "/0/mesh");
  refused(R"([{"mesh":0}])", "/0/vertices");
  refused(R"([{"mesh":-1,"vertices":[1]}])", "/0/mesh");
  refused(R"([{"mesh":0,"primitive":"x","vertices":[1]}])", "/0/primitive");
  refused(R"([{"mesh":0,"vertices":[1,-1]}])", "/0/vertices/1");
  refused(R"([{"mesh":0,"vertices":7}])", "/0/vertices");
  refused(R"([{"mesh":0,"vertices":[1]},{"mesh":0,"vertices":[1],"x":1}])", "/1/x");
  check_refused(R"({"features":1})", ErrorCode::invalid_parameters, "/features");
}

TEST_CASE("more fixed vertices than the limit are refused, in one list or in many") {
  const auto list = [](std::size_t count) {
    std::string text = "[0";
    for (std::size_t i = 1; i < count; ++i) text += ",0";
    return text + "]";
  };
  const std::string half = list(kMostFixedVertices / 2);
  const auto two = [&](const std::string& second) {
    return R"({"fixed_vertices":[{"mesh":0,"vertices":)" + half + R"(},{"mesh":1,"vertices":)" +
           second + "}]}";
  };
  CHECK(good(two(half)).fixed_vertices.size() == 2);
  const auto refused = [](const std::string& text, const std::string& pointer) {
    const Result<Parameters> parameters = parse_parameters(text);
    REQUIRE_FALSE(parameters);
    CHECK(parameters.error().code == ErrorCode::invalid_parameters);
    CHECK(parameters.error().pointer == pointer);
  };
  refused(two(list(kMostFixedVertices / 2 + 1)), "/fixed_vertices/1/vertices");
  refused(R"({"fixed_vertices":)" + list(kMostFixedVertices + 1) + "}", "/fixed_vertices");
}

TEST_CASE("meshes and nodes select, empty lists and what is no index are refused") {
  CHECK(good("{}").selection.all());
  CHECK_FALSE(parameters_document(good("{}")).contains("meshes"));
  const Parameters p = good(R"({"meshes":[2,0],"nodes":[7]})");
  CHECK_FALSE(p.selection.all());
  CHECK(p.selection.meshes == std::vector<Index>{2, 0});
  CHECK(p.selection.nodes == std::vector<Index>{7});
  const auto invalid = ErrorCode::invalid_parameters;
  for (const std::string key : {"meshes", "nodes"}) {
    check_refused("{\"" + key + "\":[]}", invalid, "/" + key);
    check_refused("{\"" + key + "\":\"all\"}", invalid, "/" + key);
    check_refused("{\"" + key + "\":3}", invalid, "/" + key);
    check_refused("{\"" + key + "\":[0,-1]}", invalid, "/" + key + "/1");
    check_refused("{\"" + key + "\":[0.5]}", invalid, "/" + key + "/0");
  }
}

TEST_CASE("weld and the space of the curvature are names of closed sets") {
  CHECK(good("{}").welding == Welding::position);
  CHECK(good(R"({"weld":"position"})").welding == Welding::position);
  CHECK(good(R"({"weld":"none"})").welding == Welding::none);
  CHECK(parameters_document(good(R"({"weld":"none"})"))["weld"] == "none");
  check_refused(R"({"weld":false})", ErrorCode::invalid_parameters, "/weld");
  CHECK(good("{}").curvature.space == CurvatureSpace::local);
  CHECK(good(R"({"curvature_space":"world"})").curvature.space == CurvatureSpace::world);
  CHECK(parameters_document(good("{}"))["curvature_space"] == "local");
  check_refused(R"({"curvature_space":"scene"})", ErrorCode::invalid_parameters,
                "/curvature_space");
}

TEST_CASE("colours are asked for by true or by their settings") {
  CHECK_FALSE(good("{}").curvature.colors);
  CHECK_FALSE(good(R"({"colors":false})").curvature.colors);
  CHECK(good(R"({"curvature":[]})").curvature.none());
  const auto plain = good(R"({"colors":true,"curvature":[]})").curvature;
  CHECK_FALSE(plain.none());
  REQUIRE(plain.colors);
  CHECK_FALSE(plain.colors->limit);
  CHECK_FALSE(plain.colors->replace);
  const auto set = good(R"({"colors":{"limit":2.5,"replace":true}})").curvature.colors;
  REQUIRE(set);
  CHECK(set->limit == 2.5);
  CHECK(set->replace);
  CHECK_FALSE(good(R"({"colors":{"limit":"auto"}})").curvature.colors->limit);
  CHECK(parameters_document(good("{}"))["colors"] == false);
  const auto invalid = ErrorCode::invalid_parameters;
  check_refused(R"({"colors":"red"})", invalid, "/colors");
  check_refused(R"({"colors":{"limit":0}})", invalid, "/colors/limit");
  check_refused(R"({"colors":{"limit":-1}})", invalid, "/colors/limit");
  check_refused(R"({"colors":{"replace":1}})", invalid, "/colors/replace");
  check_refused(R"({"colors":{"map":"jet"}})", invalid, "/colors/map");
}

TEST_CASE("lambda together with feature_angle is refused") {
  check_refused(R"({"lambda":0.1,"feature_angle":30})", ErrorCode::invalid_parameters, "/lambda");
}

TEST_CASE("compression and Draco's settings are read, stated and checked") {
  const Parameters none = good("{}");
  CHECK(none.encoding.compression == Compression::none);
  CHECK(none.encoding.draco.position_bits == 14);
  CHECK(none.encoding.draco.keep_order);
  const Parameters p = good(R"({"output":"drc","compression":"keep","draco":{"position_bits":0,
      "normal_bits":8,"texcoord_bits":11,"curvature_bits":20,"level":10,"keep_order":false}})");
  CHECK(p.output == Format::drc);
  CHECK(p.encoding.compression == Compression::keep);
  CHECK(p.encoding.draco.position_bits == 0);
  CHECK(p.encoding.draco.normal_bits == 8);
  CHECK(p.encoding.draco.texcoord_bits == 11);
  CHECK(p.encoding.draco.curvature_bits == 20);
  CHECK(p.encoding.draco.level == 10);
  CHECK_FALSE(p.encoding.draco.keep_order);
  const Json document = parameters_document(p);
  CHECK(parameters_document(good(document.dump())) == document);
  CHECK(document["compression"] == "keep");
  CHECK(document["draco"] == Json{{"position_bits", 0},
                                  {"normal_bits", 8},
                                  {"texcoord_bits", 11},
                                  {"curvature_bits", 20},
                                  {"level", 10},
                                  {"keep_order", false}});
  const auto invalid = ErrorCode::invalid_parameters;
  check_refused(R"({"compression":"zip"})", invalid, "/compression");
  check_refused(R"({"draco":7})", invalid, "/draco");
  check_refused(R"({"draco":{"bits":7}})", invalid, "/draco/bits");
  check_refused(R"({"draco":{"position_bits":31}})", invalid, "/draco/position_bits");
  check_refused(R"({"draco":{"position_bits":-1}})", invalid, "/draco/position_bits");
  check_refused(R"({"draco":{"normal_bits":1}})", invalid, "/draco/normal_bits");
  check_refused(R"({"draco":{"texcoord_bits":1.5}})", invalid, "/draco/texcoord_bits");
  check_refused(R"({"draco":{"curvature_bits":"auto"}})", invalid, "/draco/curvature_bits");
  check_refused(R"({"draco":{"level":11}})", invalid, "/draco/level");
  check_refused(R"({"draco":{"keep_order":1}})", invalid, "/draco/keep_order");
}

}  // namespace fairway::test
