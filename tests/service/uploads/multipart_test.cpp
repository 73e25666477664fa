// Scenes of several files, sent to the real service as forms.

#include <fstream>
#include <string>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/sample_scene.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

const std::string kThree = R"({"steps":3})";

struct Fixture {
  Answer denoise(const std::vector<FormPart>& parts) const {
    return client.post("/v1/denoise", form_body(parts), kFormType);
  }
  Json job_of(const Answer& answer) const { return client.get(answer.header("location")).json(); }

  TemporaryDirectory directory;
  ServiceProcess service{directory.path(), {}};
  HttpClient client = service.client();
};

/// Most memory the service has ever had, in KiB.
long peak_memory(const ServiceProcess& service) {
  std::ifstream status(fmt::format("/proc/{}/status", service.pid()));
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stol(line.substr(6));
  }
  FAIL("the kernel does not say");
  return 0;
}

}  // namespace

TEST_CASE("a scene and its files come back as the tool writes them, however the parts are named") {
  const Fixture f;
  const SampleScene scene;
  const std::string expected = denoised_by_tool(scene, "out.gltf", kThree);
  REQUIRE(expected.size() > scene.bin.size());
  std::vector<FormPart> by_part = scene.parts(kThree);
  by_part[0] = {"scene.gltf", "", scene.gltf()};
  by_part[1] = {SampleScene::kBin, "", scene.bin};
  const std::vector<FormPart> by_file = {{"files", SampleScene::kPng, scene.png},
                                         {"files", SampleScene::kBin, scene.bin},
                                         {"files", "scene.gltf", scene.gltf()},
                                         {"params", "", kThree}};
  for (const auto& parts : {scene.parts(kThree), by_part, by_file}) {
    const Answer answer = f.denoise(parts);
    CAPTURE(answer.status, answer.body.substr(0, 300));
    REQUIRE(answer.status == 200);
    CHECK(answer.header("content-type") == "model/gltf+json");
    CHECK((answer.body == expected));
    const Json job = f.job_of(answer);
    CHECK(job["input"]["files"] == 3);
    CHECK(job["report"]["notes"].empty());
  }
}

TEST_CASE("a job of several files keeps the form's parameters and becomes a GLB on request") {
  const Fixture f;
  const SampleScene scene;
  const std::string glb = R"({"steps":3,"output":"glb"})";
  const Answer accepted = f.client.post("/v1/jobs", form_body(scene.parts(glb)), kFormType);
  REQUIRE(accepted.status == 202);
  const std::string path = accepted.header("location");
  const Json job = wait_until_final(f.client, path);
  CAPTURE(job.dump());
  REQUIRE(job["state"] == "succeeded");
  CHECK(job["parameters"]["steps"] == 3);
  CHECK(job["input"]["format"] == "gltf");
  const std::string result = f.client.get(path + "/result").body;
  CHECK((result == denoised_by_tool(scene, "out.glb", kThree)));
}

TEST_CASE("a file that a scene needs and nobody sent is named in the problem") {
  const Fixture f;
  const SampleScene scene;
  auto parts = scene.parts(kThree);
  parts[1].file_name = "scene%20data%c3%A4.bin";  // escapes belong into the URI, not into the name
  const Answer answer = f.denoise(parts);
  CHECK(answer.status == 422);
  CHECK(answer.problem() == "invalid_mesh");
  CHECK(answer.json()["pointer"] == "/buffers/0/uri");
  const std::string detail = answer.json()["detail"];
  CHECK(detail.find('"' + SampleScene::kBin + '"') != std::string::npos);

  const Answer alone = f.denoise({{"scene", "scene.gltf", scene.gltf()}});
  CHECK(alone.status == 422);
  CHECK(alone.json()["detail"].get<std::string>().find("scene%20data%c3%A4.bin") !=
        std::string::npos);
  CHECK(alone.json()["pointer"] == "/buffers/0/uri");
}

TEST_CASE("an image that nobody sent stays a reference, with a note") {
  const Fixture f;
  const SampleScene scene;
  auto parts = scene.parts(kThree);
  parts.erase(parts.begin() + 2);
  const Answer answer = f.denoise(parts);
  REQUIRE(answer.status == 200);
  CHECK(answer.json()["images"][0]["uri"] == "skins/%61.png");
  CHECK(f.job_of(answer)["report"]["notes"].dump().find("images/0") != std::string::npos);
}

TEST_CASE("a part that the mesh does not name is noted and changes nothing") {
  const Fixture f;
  const SampleScene scene;
  auto parts = scene.parts(kThree);
  parts.push_back({"readme", "../../etc/passwd", "some text"});
  const Answer answer = f.denoise(parts);
  REQUIRE(answer.status == 200);
  CHECK((answer.body == denoised_by_tool(scene, "out.gltf", kThree)));
  const Json notes = f.job_of(answer)["report"]["notes"];
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].get<std::string>().find("\"../../etc/passwd\"") != std::string::npos);

  const std::string glb = small_glb();
  const Answer beside = f.denoise({{"a", "a.glb", glb}, {"b", "b.bin", "x"}, {"c", "c", ""}});
  REQUIRE(beside.status == 200);
  CHECK((beside.body == f.client.post("/v1/denoise", glb).body));
  CHECK(f.job_of(beside)["report"]["notes"].size() >= 2);
}

TEST_CASE("a form with one file is the same job as that file alone") {
  const Fixture f;
  const std::string glb = small_glb();
  const Answer raw = f.client.post("/v1/denoise", glb);
  const Answer form = f.denoise({{"scene", "a.glb", glb}});
  REQUIRE(form.status == 200);
  CHECK((form.body == raw.body));
  CHECK(f.job_of(form)["input"] == f.job_of(raw)["input"]);
  CHECK_FALSE(f.job_of(form)["input"].contains("files"));
}

TEST_CASE("hostile names and too many parts are refused, and the service lives on") {
  const Fixture f;
  const SampleScene scene(5);
  const auto status_with = [&](const std::vector<FormPart>& more) {
    auto parts = scene.parts(kThree);
    parts.insert(parts.end(), more.begin(), more.end());
    const Answer answer = f.denoise(parts);
    if (answer.status == 400) CHECK(answer.problem() == "bad_request");
    return answer.status;
  };
  for (const std::string& name :
       {SampleScene::kBin, std::string(256, 'x'), std::string(8000, 'x'), std::string(200000, 'x'),
        std::string("a\tb"), std::string("a\0b", 3), std::string("\xFF\xFE"),
        std::string("a\r\nContent-Type: b\r\n\r\n")}) {
    CAPTURE(name.substr(0, 40));
    CHECK(status_with({{"x", name, "y"}}) == 400);
  }
  CHECK(status_with({{"", "", "y"}}) == 400);
  CHECK(status_with({{"params", "", "{}"}}) == 400);
  CHECK(status_with({{"x", std::string(255, 'x'), "y"}}) == 200);
  std::vector<FormPart> many;
  many.reserve(6000);
  for (int i = 0; i < 12; ++i) many.push_back({"x", fmt::format("x{}", i), ""});
  CHECK(status_with(many) == 200);
  many.push_back({"x", "one more", ""});
  CHECK(status_with(many) == 400);
  for (int i = 0; i < 5000; ++i) many.push_back({"x", fmt::format("y{}", i), ""});
  CHECK(status_with(many) == 400);
  CHECK(f.client.get("/livez").status == 200);
}

TEST_CASE("all parts of a form together stay within the body limit") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--max-body", "3000"});
  const std::vector<FormPart> parts = {{"a", "a.glb", small_glb()},
                                       {"b", "b.bin", std::string(1500, 'x')},
                                       {"c", "c.bin", std::string(1500, 'x')}};
  const Answer answer = service.client().post("/v1/denoise", form_body(parts), kFormType);
  CHECK(answer.status == 413);
  CHECK(answer.problem() == "too_large");
}

TEST_CASE("a scene that names one small file a thousand times is refused") {
  const Fixture f;
  SampleScene scene;
  scene.png += std::string(1 << 20, 'x');
  for (int i = 0; i < 1000; ++i) scene.json["images"].push_back({{"uri", "skins/a.png"}});
  const Answer answer = f.denoise(scene.parts(kThree));
  CHECK(answer.status == 413);
  CHECK(answer.problem() == "too_large");
}

TEST_CASE("large files of a form go to the disk and not into the service's memory") {
  const Fixture f;
  f.denoise({{"a", "a.glb", small_glb()}, {"b", "b.bin", "x"}});
  const long before = peak_memory(f.service);
  const std::string large(20 << 20, 'x');
  REQUIRE(f.denoise({{"a", "a.glb", small_glb()}, {"b", "b.bin", large}, {"c", "c.bin", large}})
              .status == 200);
  CHECK(peak_memory(f.service) - before < 8 << 10);
}
