// What all walks share, and how to get every documented answer about the service itself.

#include "tests/service/contract/contract_walks.h"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "server/fairwayd/http/http_head.h"
#include "server/fairwayd/store/sqlite.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/uploads/tus_client.h"

namespace fairway::test {
namespace {

/// As many connections as the service serves at a time.
constexpr std::size_t kAllConnections = 512;

/// Asks a service whose connections are all taken, by clients that are not slow yet.
Answer ask_in_full_house(const Stage& stage, const WireRequest& request) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    std::vector<RawConnection> crowd;
    crowd.reserve(kAllConnections);
    for (std::size_t i = 0; i < kAllConnections; ++i) {
      crowd.emplace_back(stage.service.port());
      crowd.back().send("POST /v1/inspect HTTP/1.1\r\nHost: t\r\nContent-Length: 9\r\n\r\ng");
    }
    Answer answer = stage.ask(request);
    if (answer.status == 503) return answer;
    REQUIRE(std::chrono::steady_clock::now() < until);
  }
}

/// What is answered whatever the load.
bool is_vital(const std::string& path) {
  return path == "/livez" || path == "/readyz";
}

void walk_plain(ContractWalk& walk) {
  const Stage stage;
  const std::string path = walk.operation().path;
  walk.see(ask(walk, stage, path));
  check_head(walk, stage, path);
  see_header_examples(walk, stage, {walk.operation().method, path, {}, ""});
  see_common(walk, stage, path);
}

/// A file that a page of its folder names.
std::string file_below(const Stage& stage, const std::string& folder) {
  if (folder == "/samples/") return folder + "ring.glb";
  const std::string page = stage.client().get(folder == "/docs/" ? "/docs" : "/").body;
  const std::size_t at = page.find('"' + folder);
  // Where the page was left out, its folder is empty.
  if (at == std::string::npos) return "/docs/style.css";
  return page.substr(at + 1, page.find('"', at + 1) - at - 1);
}

void walk_page(ContractWalk& walk) {
  const Stage stage;
  const std::string pattern = walk.operation().path;
  std::string path = pattern;
  if (pattern.ends_with("{file}")) {
    path = file_below(stage, pattern.substr(0, pattern.find('{')));
    walk.see(ask(walk, stage, filled(pattern, "nothing.js")));
  }
  const Answer answer = ask(walk, stage, path);
  walk.see(answer);
  walk.see(ask(walk, stage, path, {"If-None-Match: " + answer.header("etag")}));
  check_head(walk, stage, path);
  see_header_examples(walk, stage, {walk.operation().method, path, {}, ""});
  // Last, because it leaves a house that takes a moment to get empty.
  see_common(walk, stage, path);
}

void walk_readiness(ContractWalk& walk) {
  const Stage stage;
  walk.see(ask(walk, stage, "/readyz"));
  walk.see(ask(walk, stage, "/readyz?canary=1"));
  walk.see(ask(walk, stage, "/readyz?canary=2"));
  check_head(walk, stage, "/readyz");
  see_common(walk, stage, "/readyz");
  std::filesystem::remove_all(stage.directory.path() / "spool");
  const auto until = std::chrono::steady_clock::now() + kPatience;
  Answer answer = ask(walk, stage, "/readyz");
  while (answer.status != 503) {  // what it found stays found for a second
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    answer = ask(walk, stage, "/readyz");
  }
  walk.see(answer);
}

void walk_metrics(ContractWalk& walk) {
  const Stage stage;
  walk.see(ask(walk, stage, "/metrics"));
  CHECK(stage.ask({"HEAD", "/metrics", {}, ""}).status == 200);
  see_header_examples(walk, stage, {"GET", "/metrics", {}, ""});
  see_common(walk, stage, "/metrics");
  const Stage parted({"--admin-listen", "127.0.0.1:0"});
  walk.see(ask(walk, parted, "/metrics"));
  walk.see(exchange(parted.service.admin_port(), {"GET", "/metrics", {}, ""}));
}

}  // namespace

std::string query_text(const Json& parameter, const Json& value) {
  const std::string name = parameter["name"];
  std::string text;
  for (const Json& one : value.is_array() ? value : Json::array({value})) {
    const std::string shown = one.is_string() ? one.get<std::string>() : one.dump();
    if (!text.empty()) text += '&';
    text += fmt::format("{}={}", name, percent_encoded(shown));
  }
  return text;
}

Answer ask(const ContractWalk& walk, const Stage& stage, const std::string& path,
           const std::vector<std::string>& headers) {
  return stage.ask({walk.operation().method, path, headers, ""});
}

void check_head(const ContractWalk& walk, const Stage& stage, const std::string& path) {
  const Answer get = ask(walk, stage, path);
  const Answer head = stage.ask({"HEAD", path, {}, ""});
  CHECK(head.status == get.status);
  CHECK(head.header("content-type") == get.header("content-type"));
  CHECK(head.header("etag") == get.header("etag"));
  CHECK(head.header("content-length") == std::to_string(get.body.size()));
  CHECK(head.body.empty());
}

void see_header_examples(ContractWalk& walk, const Stage& stage, const WireRequest& request) {
  for (const Json& parameter : walk.operation().parameters) {
    if (parameter["in"] != "header") continue;
    std::vector<std::string> values;
    if (parameter.contains("example")) values.push_back(parameter["example"]);
    const Json examples = parameter.value("examples", Json::object());
    for (const Json& example : examples) values.push_back(example["value"]);
    CHECK_FALSE(values.empty());
    for (const std::string& value : values) {
      WireRequest sent = request;
      std::erase_if(sent.headers, [&](const std::string& header) {
        return header.starts_with(parameter["name"].get<std::string>() + ":");
      });
      sent.headers.push_back(parameter["name"].get<std::string>() + ": " + value);
      CAPTURE(sent.headers.back());
      walk.see(stage.ask(sent));
    }
  }
}

SlowRequests::SlowRequests(const Operation& operation, std::uint16_t port) {
  const std::string begin =
      operation.method + " " + path_with(operation, kNobody) + " HTTP/1.1\r\n";
  connections_.emplace_back(port).send(begin + "Host:");
  if (operation.body.is_null()) return;
  if (operation.id == "continueUpload") {
    const std::string path = TusClient(HttpClient(port)).created(9);
    connections_.emplace_back(port).send(patch_head(path, 0, 9) + "abc");
    return;
  }
  std::string head = begin + "Host: t\r\nContent-Length: 9\r\n";
  for (const Json& parameter : operation.parameters) {
    if (!parameter.value("required", false) || parameter["in"] != "header") continue;
    head += fmt::format("{}: {}\r\n", parameter["name"].get<std::string>(),
                        parameter["example"].get<std::string>());
  }
  if (operation.id == "createUpload") head += "Content-Type: application/offset+octet-stream\r\n";
  connections_.emplace_back(port).send(head + "\r\nabc");
}

void SlowRequests::see(ContractWalk& walk) {
  for (RawConnection& connection : connections_) {
    const Answer answer = parsed_answer(connection.read_all());
    CHECK(answer.status == 408);
    walk.see(answer);
  }
}

void see_common(ContractWalk& walk, const Stage& stage, const std::string& path) {
  const std::string& method = walk.operation().method;
  const std::string too_long(kMaxHeadLine + 1, 'x');
  walk.see(stage.ask({method, path, {"Content-Length: many"}, ""}));
  walk.see(stage.ask({method, path + "?" + too_long, {}, ""}));
  walk.see(stage.ask({method, path, {"X-Long: " + too_long}, ""}));
  if (!is_vital(path)) walk.see(ask_in_full_house(stage, {method, path, {}, ""}));
}

void break_store(const Stage& stage) {
  auto database = Database::open(stage.directory.path() / "jobs.sqlite");
  REQUIRE(database);
  REQUIRE(database->execute("DROP TABLE upload; DROP TABLE job"));
}

std::vector<RefusedMesh> refused_meshes() {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 0\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n";
  std::string newer = ply;
  newer.replace(newer.find("1.0"), 3, "2.0");
  const std::string endless_line = "v 0 0 0\n#" + std::string(std::size_t{5} << 20, 'x') + "\n";
  return {{"malformed_input", small_glb(Flaw::truncated)},
          {"too_large", endless_line},
          {"unsupported_format", newer},
          {"unsupported_feature",
           R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_unknown"],
               "extensionsUsed":["EXT_unknown"]})"},
          {"invalid_mesh", small_glb(Flaw::not_a_number)},
          {"no_triangles", ply},
          {"invalid_parameters", small_glb(), R"({"fixed_vertices":[99]})"},
          {"diverged", noisy_torus(20),
           R"({"method":"mean_curvature","steps":50,"step_size":1000,
               "guards":{"local_step":false}})"}};
}

void kill_workers_until(const Stage& stage, const std::function<bool()>& enough) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!enough()) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    for (const pid_t worker : stage.service.workers()) ::kill(worker, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

std::map<std::string, Walk> contract_walks() {
  return {
      {"denoise", walk_denoise},
      {"submitJob", walk_submit_job},
      {"putJob", walk_put_job},
      {"retryJob", walk_retry_job},
      {"listJobs", walk_list_jobs},
      {"showJob", walk_show_job},
      {"deleteJob", walk_delete_job},
      {"showResult", walk_show_result},
      {"followJob", walk_follow_job},
      {"cancelJob", walk_cancel_job},
      {"listDeliveries", walk_list_deliveries},
      {"redeliver", walk_redeliver},
      {"describeUploads", walk_describe_uploads},
      {"createUpload", walk_create_upload},
      {"showUpload", walk_show_upload},
      {"continueUpload", walk_continue_upload},
      {"deleteUpload", walk_delete_upload},
      {"inspect", walk_inspect},
      {"listMethods", walk_plain},
      {"showContract", walk_plain},
      {"showPage", walk_page},
      {"showPageFile", walk_page},
      {"showSample", walk_page},
      {"showDocs", walk_page},
      {"showDocsFile", walk_page},
      {"checkLiveness", walk_plain},
      {"checkReadiness", walk_readiness},
      {"showMetrics", walk_metrics},
  };
}

}  // namespace fairway::test
