// The collection of hostile inputs that may stand beside the project: how each is sent, and what it
// is to come to.
#include "tests/hostile/shared_cases.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

#include <fmt/format.h>

#include "proto/messages/json.h"
#include "tests/hostile/wire.h"
#include "tests/places.h"

namespace fairway::hostile {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kRawPause{1500};
constexpr milliseconds kLongest{30000};
constexpr const char* kBoundary = "an-edge-of-no-file";

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  expect(static_cast<bool>(file), "cannot read " + path.string());
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string folder_of(const SharedCase& shared) {
  return shared.file.substr(0, shared.file.find('/'));
}

/// The type that a file is sent as; empty where there is none, so that its name has to tell.
std::string type_of(const SharedCase& shared) {
  const std::string folder = folder_of(shared);
  if (folder == "http") return "model/gltf-binary";  // declared so, and something else
  const std::string extension = std::filesystem::path(shared.file).extension();
  if (extension == ".glb") return "model/gltf-binary";
  if (extension == ".gltf") return "model/gltf+json";
  if (extension == ".obj") return "model/obj";
  if (extension == ".ply") return "model/ply";
  if (extension == ".stl") return "model/stl";
  return {};
}

/// A form whose mesh is told by its name alone.
Submit form_with(const std::string& mesh, const std::string& extension,
                 const std::optional<std::string>& parameters) {
  const auto part = [](const std::string& disposition, const std::string& content) {
    return fmt::format("--{}\r\nContent-Disposition: form-data; {}\r\n\r\n{}\r\n", kBoundary,
                       disposition, content);
  };
  std::string body = part(fmt::format("name=\"mesh\"; filename=\"case{}\"", extension), mesh);
  if (parameters) body += part("name=\"params\"", *parameters);
  body += fmt::format("--{}--\r\n", kBoundary);
  return {"/v1/jobs", fmt::format("multipart/form-data; boundary={}", kBoundary), std::move(body)};
}

void replace_all(std::string& text, const std::string& mark, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += by.size()) {
    text.replace(at, mark.size(), by);
  }
}

/// What a job's end says.
void follow(const Target& target, const std::string& path, steady_clock::time_point began,
            Verdict& verdict) {
  while (milliseconds_since(began) < static_cast<double>(kLongest.count())) {
    const test::Answer answer = target.client().get(path);
    const auto job = parse_json(answer.body);
    if (answer.status != 200 || !job || !job->contains("state")) {
      verdict.outcome = fmt::format("{} for the job", answer.status);
      verdict.has_server_error = answer.status >= 500;
      return;
    }
    const std::string state = (*job)["state"];
    if (state == "succeeded") {
      verdict.outcome = "accept";
      return;
    }
    if (state != "queued" && state != "running") {
      const Json problem = job->value("problem", Json::object());
      verdict.outcome = fmt::format("{}", problem.value("status", 0));
      // A dead worker is a defect of ours, whatever status it is told with.
      const std::string code = problem.value("code", std::string());
      verdict.has_server_error = problem.value("status", 500) >= 500 || code == "worker_crashed" ||
                                 code == "decoder_failed";
      verdict.detail = problem.value("detail", std::string());
      return;
    }
    std::this_thread::sleep_for(milliseconds(3));
  }
  verdict.outcome = "nothing";
}

/// `answer`: of the submit itself.
void judge(const Target& target, const test::Answer& answer, steady_clock::time_point began,
           Verdict& verdict) {
  verdict.has_server_error = answer.status >= 500;
  verdict.location = answer.header("location");
  if (answer.status == 202 && !verdict.location.empty()) {
    follow(target, verdict.location, began, verdict);
  } else if (answer.status / 100 == 2) {
    verdict.outcome = "accept";
  } else {
    verdict.outcome = answer.status == 0 ? "nothing" : fmt::format("{}", answer.status);
    verdict.detail = answer.body.substr(0, 300);
  }
  verdict.milliseconds = milliseconds_since(began);
}

/// Closing without an answer refuses where the client itself cut the request, or it is no HTTP.
bool may_be_closed(const SharedCase& shared) {
  constexpr std::array<std::string_view, 2> kCut = {"http/garbage.raw", "http/cl_long.raw"};
  return std::find(kCut.begin(), kCut.end(), shared.file) != kCut.end();
}

}  // namespace

std::optional<std::vector<SharedCase>> shared_cases() {
  const auto folder = test::shared("bad");
  if (!folder) return std::nullopt;
  const auto manifest = parse_json(read_file(*folder / "manifest.json"));
  expect(manifest && manifest->contains("files"), "manifest.json is no manifest");
  std::vector<SharedCase> cases;
  for (const Json& row : (*manifest)["files"]) {
    SharedCase shared{row["file"], row["category"], row["expected"], {}};
    shared.bytes = read_file(*folder / shared.file);
    expect(shared.bytes.size() == row["bytes"].get<std::size_t>(),
           shared.file + " has another size than the manifest says");
    cases.push_back(std::move(shared));
  }
  return cases;
}

std::optional<Submit> submit_of(const SharedCase& shared, const std::string& control) {
  if (shared.file.ends_with(".raw")) return std::nullopt;
  if (folder_of(shared) == "params") {
    return form_with(control, ".glb", shared.bytes);
  }
  const std::string type = type_of(shared);
  if (!type.empty()) return Submit{"/v1/jobs", type, shared.bytes};
  return form_with(shared.bytes, std::filesystem::path(shared.file).extension().string(), {});
}

Verdict submit(const Target& target, const Submit& submit) {
  Verdict verdict;
  const auto began = steady_clock::now();
  Wire wire(target.port());
  wire.send(head_of("POST", submit.path,
                    {"Content-Type: " + submit.type,
                     fmt::format("Content-Length: {}", submit.body.size())}) +
                submit.body,
            kLongest);
  wire.read_answer(kLongest);
  const Answers answers = answers_in(wire.received());
  verdict.heads = answers.heads;
  judge(target, answers.whole.empty() ? test::Answer{} : answers.whole.front(), began, verdict);
  return verdict;
}

Verdict send_raw(const Target& target, const SharedCase& shared) {
  std::string bytes = shared.bytes;
  replace_all(bytes, "@PATH@", "/v1/jobs");
  replace_all(bytes, "@JOBS@", "/v1/jobs");
  replace_all(bytes, "@LIVE@", "/livez");
  Verdict verdict;
  const auto began = steady_clock::now();
  Wire wire(target.port());
  wire.send(bytes, kLongest);
  wire.read_answer(kRawPause);
  const double answered = milliseconds_since(began);
  wire.read_until_closed(kRawPause - std::chrono::ceil<milliseconds>(steady_clock::now() - began));
  wire.half_close();
  wire.read_until_closed(kLongest);
  const Answers answers = answers_in(wire.received());
  verdict.heads = answers.heads;
  if (answers.whole.empty()) {
    verdict.outcome = wire.is_closed() && may_be_closed(shared) ? "closed" : "nothing";
    verdict.milliseconds = milliseconds_since(began);
    return verdict;
  }
  for (const test::Answer& answer : answers.whole) {
    // What follows a refusal in the same bytes was never a request.
    if (&answer != &answers.whole.front() && answers.whole.front().status >= 400) {
      verdict.outcome = "a second answer behind a refusal";
      return verdict;
    }
    judge(target, answer, began, verdict);
    if (verdict.outcome != "accept") break;
  }
  // The pause is the client's.
  if (answers.whole.front().status != 202) verdict.milliseconds = answered;
  if (verdict.outcome != "accept" && !wire.is_closed()) verdict.outcome += ", left open";
  return verdict;
}

bool is_expected(const SharedCase& shared, const std::string& outcome) {
  if (outcome == "closed") return true;
  const std::string all = "|" + shared.expected + "|";
  return all.find("|" + outcome + "|") != std::string::npos;
}

}  // namespace fairway::hostile
