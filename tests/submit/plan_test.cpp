// Where results go.
#include "server/fairway-submit/plan.h"

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

Result<std::vector<BatchFile>> plan(const std::vector<std::filesystem::path>& files,
                                    const char* parameters = "{}",
                                    const std::filesystem::path& out = "/nowhere/out") {
  SubmitOptions options;
  options.files = files;
  options.out = out;
  auto json = parse_json(parameters);
  REQUIRE(json);
  options.parameters = *std::move(json);
  return plan_batch(options);
}

std::string name_of_only(const std::filesystem::path& file, const char* parameters) {
  const auto files = plan({file}, parameters);
  REQUIRE(files);
  return files->front().name;
}

void check_refused(const Result<std::vector<BatchFile>>& planned) {
  REQUIRE_FALSE(planned);
  CHECK(planned.error().code == ErrorCode::usage);
}

}  // namespace

TEST_CASE("a result has its input's name, or another extension where a format is chosen") {
  CHECK(name_of_only("/a/part.glb", "{}") == "part.glb");
  CHECK(name_of_only("part.GLB", "{}") == "part.GLB");
  CHECK(name_of_only("part.glb", R"({"output":"ply"})") == "part.ply");
  CHECK(name_of_only("part.PLY", R"({"output":"ply"})") == "part.PLY");
  CHECK(name_of_only("scan.v2", R"({"output":"ply"})") == "scan.v2.ply");
  CHECK(name_of_only("scan", "{}") == "scan");
  CHECK(name_of_only("part.glb", R"({"output":"nonsense"})") == "part.glb");
}

TEST_CASE("two inputs never share a result") {
  check_refused(plan({"a/part.glb", "b/part.glb"}));
  check_refused(plan({"part.glb", "part.glb"}));
  check_refused(plan({"part.glb", "part.stl"}, R"({"output":"ply"})"));
  CHECK(plan({"part.glb", "part.stl"}));
}

TEST_CASE("a result never replaces an input") {
  check_refused(plan({"in/part.glb"}, "{}", "in"));
  check_refused(plan({"in/part.glb"}, "{}", "in/../in/."));
  check_refused(plan({"in/part.glb", "in/part.ply"}, R"({"output":"ply"})", "in"));
  CHECK(plan({"in/part.glb"}, R"({"output":"ply"})", "in"));
}

TEST_CASE("names that the program needs itself are refused") {
  check_refused(plan({".fairway-submit.jsonl"}));
  check_refused(plan({"folder/"}));
  check_refused(plan({".."}));
}
