// The command line of fairway-submit.

#include "server/fairway-submit/options.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::size_t kMostInFlight = 64;
constexpr std::int64_t kLongestRetry = 30L * 24 * 3600;

constexpr const char* kFooter = R"(
Result of PATH/part.glb is DIR/part.glb, with another extension where the parameters choose
another "output". Files whose results would have the same name are refused before anything starts.
A .gltf is sent with the files that it names in its folder and below.

DIR/.fairway-submit.jsonl keeps account of the jobs: after a crash, a lost server or Ctrl-C the same
command finishes what is missing, and only that. Results are checked against their SHA-256 before
they get their names.

Tried again with growing pauses, for up to --retry-for seconds without success: connections that
are refused or break, and the answers 408, 409 (still in work), 429, 502, 503, 504 and 507.

Exit codes: 0 every file has its result; 1 some have none; 2 wrong usage, nothing was started;
3 the server could not be reached within --retry-for; 130 interrupted (the same command goes on).
)";

/// The text itself, or what is in FILE where it is "@FILE".
Result<std::string> text_or_file(const std::string& text) {
  if (!text.starts_with('@')) return text;
  std::ifstream file(text.substr(1), std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(file), {}};
  if (!file) return Error{ErrorCode::usage, fmt::format("Cannot read {}.", text.substr(1))};
  return content;
}

/// What the parameters mean is for the server to say; here they only have to be an object.
Result<Json> parameters_of(const std::string& option) {
  const auto text = text_or_file(option);
  if (!text) return text.error();
  auto json = parse_json(*text);
  if (!json) return Error{ErrorCode::usage, "--params: " + json.error().message};
  if (!json->is_object()) return Error{ErrorCode::usage, "--params must be a JSON object."};
  return json;
}

Result<std::string> api_key_of(const std::string& option) {
  auto key = text_or_file(option);
  if (!key) return key.error();
  while (key->ends_with('\n') || key->ends_with('\r')) key->pop_back();
  const bool sendable =
      std::all_of(key->begin(), key->end(), [](char c) { return c > ' ' && c < '\x7f'; });
  if (!sendable) return Error{ErrorCode::usage, "The API key holds what no header can carry."};
  return key;
}

void blot_out(const std::string& secret, int argc, char** argv) {
  if (secret.empty()) return;
  for (int i = 1; i < argc; ++i) {
    if (char* found = std::strstr(argv[i], secret.c_str())) std::memset(found, '*', secret.size());
  }
}

std::string check_label(const std::string& label) {
  const std::size_t colon = label.find(':');
  const bool whole = colon != std::string::npos && colon > 0 && colon + 1 < label.size();
  return whole ? "" : "A label has the form KEY:VALUE.";
}

/// The options as text, and what is made of them.
class CommandLine {
 public:
  CommandLine() {
    app_.set_version_flag("--version", std::string("fairway-submit ") + FAIRWAY_VERSION);
    app_.footer(kFooter);
    app_.add_option("FILES", options_.files, "Mesh files: GLB, glTF, Draco, PLY, OBJ or STL")
        ->required();
    app_.add_option("--server", server_, "http://HOST:PORT or https://HOST:PORT")->required();
    app_.add_option("--out", options_.out, "Folder for the results; made if it is not there")
        ->required();
    app_.add_option("--params", parameters_, "Parameters of all files: JSON, or @FILE");
    app_.add_option("--concurrency", options_.concurrency, "Uploads and jobs in flight at once")
        ->check(CLI::Range(std::size_t{1}, kMostInFlight))
        ->capture_default_str();
    app_.add_option("--retry-for", retry_for_, "Seconds without success after which to give up")
        ->check(CLI::Range(std::int64_t{0}, kLongestRetry))
        ->capture_default_str();
    app_.add_option("--label", options_.labels, "Label of the jobs, KEY:VALUE; may be repeated")
        ->allow_extra_args(false)
        ->check(check_label);
    app_.add_option("--api-key", api_key_, "API key, or @FILE; better in FAIRWAY_API_KEY")
        ->envname("FAIRWAY_API_KEY");
    app_.add_option("--ca-cert", options_.ca_certificate, "PEM file of who signs the server's key")
        ->check(CLI::ExistingFile);
    app_.add_flag("--retry-failed", options_.retry_failed,
                  "Send again what an earlier run saw fail for good");
    app_.add_flag("--json", options_.json, "Print a summary as JSON on standard output");
    app_.add_flag("--quiet,-q", options_.quiet, "Tell failures only");
  }

  /// Exceptions: CLI::ParseError.
  void parse(int argc, char** argv) { app_.parse(argc, argv); }
  int explain(const CLI::ParseError& error) {
    const int code = app_.exit(error, std::cout, std::cerr);
    return code == 0 ? 0 : static_cast<int>(SubmitExit::usage);
  }
  const std::string& api_key_text() const { return api_key_; }

  Result<SubmitOptions> options() && {
    auto server = parse_server_address(server_);
    if (!server) return server.error();
    auto parameters = parameters_of(parameters_);
    if (!parameters) return parameters.error();
    auto key = api_key_of(api_key_);
    if (!key) return key.error();
    options_.server = *std::move(server);
    options_.parameters = *std::move(parameters);
    options_.api_key = *std::move(key);
    options_.retry_for = std::chrono::seconds(retry_for_);
    return std::move(options_);
  }

 private:
  CLI::App app_{"fairway-submit: denoise many meshes by a fairway server", "fairway-submit"};
  SubmitOptions options_;
  std::string server_;
  std::string parameters_ = "{}";
  std::string api_key_;
  std::int64_t retry_for_ = 300;
};

}  // namespace

std::variant<SubmitOptions, int> parse_submit_options(int argc, char** argv) {
  CommandLine line;
  try {
    line.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return line.explain(e);
  }
  if (!line.api_key_text().starts_with('@')) blot_out(line.api_key_text(), argc, argv);
  auto options = std::move(line).options();
  if (options) return *std::move(options);
  fmt::print(stderr, "fairway-submit: {}\n", options.error().message);
  return static_cast<int>(SubmitExit::usage);
}

}  // namespace fairway
