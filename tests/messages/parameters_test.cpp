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

TEST_CASE("nothing and {} mean the automatic anisotropic prescribed flow") {
  for (const char* text : {"", "{}", R"({"steps":"auto","step_size":"auto","lambda":"auto"})"}) {
    const Parameters p = good(text);
    CHECK(p.flow.method == Method::anisotropic_prescribed);
    CHECK_FALSE(p.flow.steps);
    CHECK_FALSE(p.flow.step_size);
    CHECK_FALSE(p.flow.lambda);
    CHECK_FALSE(p.flow.feature_angle);
    CHECK(p.flow.guards.unfold);
    CHECK(p.flow.guards.min_component == 12);
    CHECK(p.flow.guards.local_step);
    CHECK(p.curvature.size() == 7);
    CHECK_FALSE(p.output);
  }
}

TEST_CASE("every parameter is read") {
  const Parameters p =
      good(R"({"method":"anisotropic","integration":"semi_implicit","mass":"lumped",
      "curvature_measure":"project","steps":50,
      "step_size":0.05,"feature_angle":35,"transition":8,
      "curvature_smoothing":{"passes":3,"fraction":0.5},"boundary":"fixed","conventions":"paper",
      "guards":{"unfold":false,"min_component":false,"local_step":false},
      "curvature":["mean","_CURVATURE_K1"],"output":"gltf"})");
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
  CHECK(p.curvature == std::vector{CurvatureKind::k1, CurvatureKind::mean});
  CHECK(p.output == Format::gltf);
  CHECK(good(R"({"output":{"format":"glb"}})").output == Format::glb);
}

TEST_CASE("a parameter document survives the round trip") {
  const auto* text = GENERATE("{}", R"({"lambda":0.25,"steps":7,"curvature":[]})",
                              R"({"method":"none","feature_angle":20.5,"output":"glb"})");
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

TEST_CASE("lambda together with feature_angle is refused") {
  check_refused(R"({"lambda":0.1,"feature_angle":30})", ErrorCode::invalid_parameters, "/lambda");
}

}  // namespace fairway::test
