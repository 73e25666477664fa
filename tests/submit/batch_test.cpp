// Whole batches against the real service.
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/service/support/http_client.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/sample_scene.h"
#include "tests/service/support/service_process.h"
#include "tests/submit/submit_fixture.h"

using namespace fairway;
using namespace fairway::test;

namespace fs = std::filesystem;

namespace {

/// Places with a service.
struct Service : SubmitPlace {
  explicit Service(const std::vector<std::string>& options = {}) : process(data(), options) {}
  SubmitRun run(const std::vector<std::string>& files, const std::vector<std::string>& more = {}) {
    return submit(process.port(), files, more);
  }
  ServiceProcess process;
};

/// The file of a summary that was given by this path.
Json file_of(const SubmitRun& run, const std::string& path) {
  const Json summary = run.summary();
  for (const Json& file : summary["files"]) {
    if (file["file"] == path) return file;
  }
  FAIL("no such file in the summary: " << path);
  return {};
}

std::string by_tool(const SubmitPlace& place, const std::string& input, const std::string& name,
                    const std::string& parameters) {
  const std::string output = place.write(name, "");
  SubmitProcess tool({"denoise", input, output, "--params", parameters}, {}, "fairway");
  const SubmitRun run = tool.wait();
  CAPTURE(run.errors);
  REQUIRE(run.code == 0);
  return read_file(output);
}

}  // namespace

TEST_CASE("results are what the tool makes of the files with the same parameters") {
  Service service;
  const std::string torus = service.write("torus.glb", noisy_torus(12));
  const std::string other = service.write("other.glb", small_glb());
  const std::string parameters = R"({"steps":3})";
  const SubmitRun run = service.run({torus, other}, {"--params", parameters});
  CAPTURE(run.errors);
  CHECK(run.code == 0);
  CHECK(service.results() == std::vector<std::string>{"other.glb", "torus.glb"});
  CHECK((service.result("torus.glb") == by_tool(service, torus, "a.glb", parameters)));
  CHECK((service.result("other.glb") == by_tool(service, other, "b.glb", parameters)));
  CHECK(run.summary()["counts"]["succeeded"] == 2);
  CHECK(file_of(run, torus)["result"]["file"] == (service.out() / "torus.glb").string());
}

TEST_CASE("the verb of the tool is the program, with its exit code") {
  Service service;
  const auto arguments = service.arguments(service.process.port(), service.write_meshes(1));
  std::vector<std::string> verb = {"submit"};
  verb.insert(verb.end(), arguments.begin(), arguments.end());
  CHECK(SubmitProcess(verb, {}, "fairway").wait().code == 0);
  CHECK(service.results() == std::vector<std::string>{"m000.glb"});
  CHECK(SubmitProcess({"submit"}, {}, "fairway").wait().code == 2);
  CHECK(SubmitProcess({"submit", "--help"}, {}, "fairway").wait().output.find("--concurrency") !=
        std::string::npos);
  CHECK(SubmitProcess({"--help"}, {}, "fairway").wait().output.find("submit") != std::string::npos);
}

TEST_CASE("a refused file is told with its problem and the rest goes on") {
  Service service;
  auto files = service.write_meshes(3);
  files.insert(files.begin() + 1, service.write("bad.glb", "this is no mesh"));
  files.push_back(service.write("nan.glb", small_glb(Flaw::not_a_number)));
  files.push_back(files[0] + ".missing.glb");
  const SubmitRun run = service.run(files);
  CHECK(run.code == 1);
  CHECK(service.results().size() == 3);
  CHECK(file_of(run, files[1])["problem"]["code"] == "unsupported_format");
  CHECK(file_of(run, files[4])["problem"]["code"] == "invalid_mesh");
  CHECK(file_of(run, files[5])["problem"]["code"] == "io");
  CHECK(file_of(run, files[4])["state"] == "failed");
  CHECK(run.errors.find(files[1] + ": failed: Unsupported format: ") != std::string::npos);
  CHECK(run.errors.find("3 of 6 results") != std::string::npos);
}

TEST_CASE("what failed for good is sent again only when that is asked for") {
  Service service;
  const std::string bad = service.write("nan.glb", small_glb(Flaw::not_a_number));
  const auto job = [&](const std::vector<std::string>& more = {}) {
    const SubmitRun run = service.run({bad}, more);
    CHECK(run.code == 1);
    CHECK(file_of(run, bad)["problem"]["code"] == "invalid_mesh");
    return file_of(run, bad)["job"].get<std::string>();
  };
  const std::string first = job();
  CHECK(job() == first);
  CHECK(job({"--retry-failed"}) != first);
}

TEST_CASE("a second run sends nothing, and only what has changed") {
  Service service;
  const auto files = service.write_meshes(3);
  REQUIRE(service.run(files).code == 0);
  const SubmitRun second = service.run(files);
  CHECK(second.code == 0);
  CHECK(second.summary()["counts"]["kept"] == 3);
  service.write("m001.glb", noisy_torus(6));
  const SubmitRun third = service.run(files);
  CHECK(third.code == 0);
  CHECK(third.summary()["counts"]["kept"] == 2);
  CHECK(file_of(third, files[1])["state"] == "succeeded");
  CHECK(service.process.client().get("/v1/jobs").json()["jobs"].size() == 4);
  CHECK(service.run(files, {"--params", R"({"steps":1})"}).summary()["counts"]["kept"] == 0);
}

TEST_CASE("a result that is gone is fetched again without another job") {
  Service service;
  const auto files = service.write_meshes(2);
  REQUIRE(service.run(files).code == 0);
  const std::string before = service.result("m000.glb");
  fs::remove(service.out() / "m000.glb");
  CHECK(service.run(files).code == 0);
  CHECK((service.result("m000.glb") == before));
  CHECK(service.process.client().get("/v1/jobs").json()["jobs"].size() == 2);
}

TEST_CASE("what an earlier run left half written is removed") {
  Service service;
  fs::create_directories(service.out());
  fs::copy_file(service.write("half", "glTF"), service.out() / ".fairway-submit-part-0123");
  CHECK(service.parts() == 1);
  CHECK(service.run(service.write_meshes(1)).code == 0);
  CHECK(service.parts() == 0);
}

TEST_CASE("a job that was deleted on the server is done anew") {
  Service service;
  const auto files = service.write_meshes(1);
  const SubmitRun first = service.run(files);
  REQUIRE(first.code == 0);
  const std::string job = file_of(first, files[0])["job"];
  REQUIRE(service.process.client().remove("/v1/jobs/" + job).status == 200);
  fs::remove(service.out() / "m000.glb");
  const SubmitRun second = service.run(files);
  CHECK(second.code == 0);
  CHECK(file_of(second, files[0])["job"] != job);
  CHECK(file_of(second, files[0])["result"] == file_of(first, files[0])["result"]);
}

TEST_CASE("a file that is no result of the batch is never replaced") {
  Service service;
  const auto files = service.write_meshes(2);
  fs::create_directories(service.out());
  fs::copy_file(service.write("precious.txt", "mine"), service.out() / "m000.glb");
  const SubmitRun run = service.run(files);
  CHECK(run.code == 1);
  CHECK(service.result("m000.glb") == "mine");
  CHECK(file_of(run, files[0])["problem"]["code"] == "conflict");
  CHECK(file_of(run, files[1])["state"] == "succeeded");
}

TEST_CASE("a scene is sent with the files that it names below its folder") {
  Service service;
  const SampleScene scene;
  const std::string path = service.write("scene.gltf", scene.gltf());
  service.write(SampleScene::kBin, scene.bin);
  service.write(SampleScene::kPng, scene.png);
  const std::string parameters = R"({"steps":3})";
  const SubmitRun run = service.run({path}, {"--params", parameters});
  CAPTURE(run.errors);
  CHECK(run.code == 0);
  CHECK((service.result("scene.gltf") == denoised_by_tool(scene, "out.gltf", parameters)));
}

TEST_CASE("a scene cannot make the client send what lies elsewhere") {
  Service service;
  SampleScene scene;
  service.write("secret.bin", scene.bin);
  scene.json["buffers"][0]["uri"] = "../secret.bin";
  const std::string above = service.write("below/above.gltf", scene.gltf());
  scene.json["buffers"][0]["uri"] = "link.bin";
  const std::string linked = service.write("below/linked.gltf", scene.gltf());
  fs::create_symlink("../secret.bin", fs::path(linked).parent_path() / "link.bin");
  const SubmitRun run = service.run({above, linked});
  CHECK(run.code == 1);
  for (const std::string& path : {above, linked}) {
    const std::string job = file_of(run, path)["job"];
    const Json document = service.process.client().get("/v1/jobs/" + job).json();
    CHECK(document["input"]["bytes"] == fs::file_size(path));
  }
}

TEST_CASE("parameters that are too long for a URL come by form") {
  Service service;
  const auto files = service.write_meshes(1);
  std::string vertices = "0";
  for (int i = 0; i < 3000; ++i) vertices += ",3";
  const SubmitRun run =
      service.run(files, {"--params", fmt::format(R"({{"fixed_vertices":[{}]}})", vertices)});
  CAPTURE(run.errors);
  CHECK(run.code == 0);
}

TEST_CASE("the output format names the results, and @FILE holds parameters") {
  Service service;
  const std::string parameters = service.write("p.json", R"({"output":"ply"})");
  const SubmitRun run = service.run(service.write_meshes(1), {"--params", "@" + parameters});
  CAPTURE(run.errors);
  CHECK(run.code == 0);
  CHECK(service.result("m000.ply").starts_with("ply\n"));
}
