// Which surfaces of a file are denoised, and what is not comes back untouched.

#include "proto/formats/selection.h"

#include <catch2/catch.hpp>

#include "tests/formats/draco_samples.h"
#include "tests/formats/sample_glb.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// Meshes of a cube, of points, of a cube; nodes of mesh 0, of none (with the next as child), of
/// mesh 2, of mesh 1.
SampleGlb three_meshes() {
  SampleGlb sample = cube_sample();
  const Json cube = sample.json["meshes"][0]["primitives"][0];
  sample.add_mesh(Json::array({{{"attributes", {{"POSITION", 0}}}, {"mode", 0}}}));
  sample.add_mesh(Json::array({cube}));
  sample.json["nodes"] = Json::parse(R"([{"mesh":0},{"children":[2]},{"mesh":2},{"mesh":1}])");
  return sample;
}

std::vector<bool> chosen(const Document& document, const MeshSelection& selection) {
  auto found = select_surfaces(document, selection);
  if (!found) FAIL(found.error().message);
  return *std::move(found);
}

void check_refused(const Document& document, const MeshSelection& selection,
                   const std::string& pointer) {
  const auto found = select_surfaces(document, selection);
  REQUIRE_FALSE(found);
  CHECK(found.error().code == ErrorCode::invalid_parameters);
  CHECK(found.error().pointer == pointer);
  CHECK(found.error().message.size() > 20);
}

}  // namespace

TEST_CASE("meshes and nodes together name the surfaces") {
  const auto document = decoded(three_meshes().glb());
  REQUIRE(document->surfaces().size() == 2);
  CHECK(chosen(*document, {}) == std::vector{true, true});
  CHECK(chosen(*document, {{2}, {}}) == std::vector{false, true});
  CHECK(chosen(*document, {{}, {0, 0}}) == std::vector{true, false});
  CHECK(chosen(*document, {{2}, {0}}) == std::vector{true, true});
  CHECK(describe_selection(document->surfaces(), {true, true}).empty());
  CHECK(describe_selection(document->surfaces(), {false, true}) ==
        "not selected, so left as they are: meshes/0");
}

TEST_CASE("a selection of what the file does not have is refused with the pointer of the entry") {
  const auto document = decoded(three_meshes().glb());
  check_refused(*document, {{0, 3}, {}}, "/meshes/1");
  check_refused(*document, {{1}, {}}, "/meshes/0");  // points only
  check_refused(*document, {{}, {2, 4}}, "/nodes/1");
  check_refused(*document, {{}, {1}}, "/nodes/0");  // only its child has a mesh
  check_refused(*document, {{0}, {3}}, "/nodes/0");
}

TEST_CASE("a file without a scene has mesh 0 and no nodes") {
  const auto document = decoded(draco_cube(), Format::drc);
  CHECK(chosen(*document, {{0}, {}}) == std::vector{true});
  check_refused(*document, {{0, 1}, {}}, "/meshes/1");
  check_refused(*document, {{}, {0}}, "/nodes");
}

TEST_CASE("an untouched surface comes back byte for byte, whatever the compression") {
  const auto compression =
      GENERATE(Compression::none, Compression::draco, Compression::meshopt, Compression::keep);
  SampleGlb sample = three_meshes();
  const auto document = decoded(sample.glb());
  auto results = shifted(*document, Vec3(1, 0, 0));
  add_ramp(*document, "_CURVATURE_K1", 1, results);
  results[0] = {};
  results[0].untouched = true;
  Encoding encoding;
  encoding.compression = compression;
  const auto out = document->write(results, Format::glb, encoding);
  REQUIRE(out);
  const SampleGlb after = parse_sample(out->bytes.joined());
  CHECK(after.json["meshes"][0] == sample.json["meshes"][0]);
  CHECK(after.json["meshes"][2] != sample.json["meshes"][2]);
  const std::size_t accessors = sample.json["accessors"].size();
  for (std::size_t i = 0; i < accessors; ++i) {
    CHECK(after.json["accessors"][i] == sample.json["accessors"][i]);
  }
  CHECK(Bytes(after.bin.begin(),
              after.bin.begin() + static_cast<std::ptrdiff_t>(sample.bin.size())) == sample.bin);
}
