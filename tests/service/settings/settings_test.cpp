#include "server/fairwayd/settings/settings.h"

#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "server/fairwayd/settings/setting_table.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;

namespace {

Result<Settings> parse(const std::vector<const char*>& arguments,
                       const std::vector<std::string>& environment = {}) {
  return parse_settings(arguments, environment);
}

/// Every setting with a value that is not its default.
const std::map<std::string, std::string> kValues = {
    {"data", "/d"},
    {"listen", "[::1]:0"},
    {"admin-listen", "127.0.0.1:7"},
    {"workers", "3"},
    {"queue", "4"},
    {"max-body", "5"},
    {"deadline", "6"},
    {"keep", "10"},
    {"upload-keep", "14"},
    {"forget", "11"},
    {"worker-memory", "7"},
    {"min-free", "8"},
    {"drain", "9"},
    {"worker", "/w"},
    {"auth", "keys"},
    {"cors-origins", "https://a.example,https://b.example"},
    {"rate", "12"},
    {"quota", "13"},
    {"lease", "14"},
    {"webhook-retry", "15"},
    {"webhook-allow-private", "yes"},
};

std::string file_with(const test::TemporaryDirectory& directory, const std::string& text) {
  std::string path = directory.path() / "settings";
  std::ofstream(path) << text;
  return path;
}

std::string refusal(const std::vector<const char*>& arguments,
                    const std::vector<std::string>& environment = {}) {
  const auto settings = parse(arguments, environment);
  REQUIRE_FALSE(settings);
  CHECK(settings.error().code == ErrorCode::usage);
  return settings.error().message;
}

}  // namespace

TEST_CASE("every option reaches its setting") {
  const auto settings =
      parse({"--data", "d", "--listen", "[::1]:0", "--workers", "3", "--queue", "4", "--max-body",
             "5", "--deadline", "6", "--worker-memory", "7", "--worker", "w"});
  REQUIRE(settings);
  CHECK(settings->data == "d");
  CHECK(settings->listen.host == "::1");
  CHECK(settings->listen.port == 0);
  CHECK(settings->workers == 3);
  CHECK(settings->queue == 4);
  CHECK(settings->max_body == 5);
  CHECK(settings->deadline.count() == 6);
  CHECK(settings->worker_memory == 7);
  CHECK(settings->worker == "w");
}

TEST_CASE("a command line that cannot be meant is refused") {
  const std::vector<std::vector<const char*>> broken = {
      {},
      {"--data"},
      {"--data", "d", "extra"},
      {"--data", "d", "--what", "1"},
      {"--data", "d", "--workers", "0"},
      {"--data", "d", "--workers", "-1"},
      {"--data", "d", "--queue", "1x"},
      {"--data", "d", "--listen", "8080"},
      {"--data", "d", "--listen", "host:99999"},
      {"--data", "d", "--listen", ":80"},
      {"--data", "d", "--webhook-allow-private", "maybe"},
  };
  for (const auto& arguments : broken) {
    const auto settings = parse(arguments);
    REQUIRE_FALSE(settings);
    CHECK(settings.error().code == ErrorCode::usage);
  }
}

TEST_CASE("every setting may be a flag, a variable or a line of a file") {
  REQUIRE(kValues.size() == setting_rows().size());
  CHECK(variable_of(*find_setting("max-body")) == "FAIRWAY_MAX_BODY");
  const test::TemporaryDirectory directory;
  std::vector<std::string> flags;
  std::vector<std::string> variables;
  std::string text;
  for (const SettingRow& row : setting_rows()) {
    const std::string value = kValues.at(std::string(row.name));
    flags.insert(flags.end(), {flag_of(row), value});
    variables.push_back(variable_of(row) + "=" + value);
    text += std::string(row.name) + " = " + value + "\n";
  }
  std::vector<const char*> arguments;
  arguments.reserve(flags.size());
  for (const std::string& flag : flags) arguments.push_back(flag.c_str());
  const std::string file = file_with(directory, text);
  const std::vector<Result<Settings>> all = {parse(arguments), parse({}, variables),
                                             parse({"--config", file.c_str()}),
                                             parse({}, {"FAIRWAY_CONFIG=" + file})};
  for (const auto& settings : all) {
    REQUIRE(settings);
    for (const SettingRow& row : setting_rows()) {
      CHECK(text_of(*settings, row) == kValues.at(std::string(row.name)));
    }
    CHECK(settings->unknown_variables.empty());
  }
}

TEST_CASE("a flag wins over a variable, a variable over the file, the file over the default") {
  const test::TemporaryDirectory directory;
  const std::string file =
      file_with(directory, "workers = 1\nqueue = 1\nmax-body = 1\ndata = file\n");
  const auto settings = parse(
      {"--workers", "3", "--config", file.c_str()},
      {"FAIRWAY_WORKERS=2", "FAIRWAY_QUEUE=2", "FAIRWAY_DATA=", "FAIRWAY_CONFIG=/nonexistent"});
  REQUIRE(settings);
  CHECK(settings->workers == 3);
  CHECK(settings->queue == 2);
  CHECK(settings->max_body == 1);
  CHECK(settings->data == "file");
  CHECK(settings->deadline == Settings().deadline);
}

TEST_CASE("what is printed says where it came from and reads back as the same settings") {
  const test::TemporaryDirectory directory;
  const std::string file = file_with(directory, "# mine\nqueue = 5\ndata = /d\n");
  const auto settings =
      parse({"--config", file.c_str(), "--drain", "0", "--print-config"}, {"FAIRWAY_MIN_FREE=6"});
  REQUIRE(settings);
  CHECK(settings->print_config);
  const std::string text = print_settings(*settings);
  CAPTURE(text);
  CHECK(text.find("# " + file + ":2\nqueue = 5\n") != std::string::npos);
  CHECK(text.find("# --drain\ndrain = 0\n") != std::string::npos);
  CHECK(text.find("# FAIRWAY_MIN_FREE\nmin-free = 6\n") != std::string::npos);
  CHECK(text.find("# default\nlisten = 127.0.0.1:8080\n") != std::string::npos);
  const std::string again = file_with(directory, text);
  const auto back = parse({"--config", again.c_str()});
  REQUIRE(back);
  for (const SettingRow& row : setting_rows()) {
    CHECK(text_of(*back, row) == text_of(*settings, row));
  }
}

TEST_CASE("a bad value is refused by its flag, variable or line, also where another wins") {
  const test::TemporaryDirectory directory;
  CHECK(refusal({"--data", "d", "--workers", "0"})
            .starts_with("--workers takes a whole number from 1 to 1024, not \"0\"."));
  CHECK(refusal({"--data", "d"}, {"FAIRWAY_DRAIN=soon"}).starts_with("FAIRWAY_DRAIN takes "));
  CHECK(refusal({"--data", "d", "--drain", "1"}, {"FAIRWAY_DRAIN=soon"})
            .starts_with("FAIRWAY_DRAIN takes "));
  const std::string value = file_with(directory, "data = d\n\nlisten = 80\n");
  CHECK(refusal({"--config", value.c_str()}).starts_with(value + ":3 listen takes HOST:PORT"));
  const std::string name = file_with(directory, "data = d\nlsten = [::1]:80\n");
  CHECK(refusal({"--config", name.c_str()}).starts_with(name + ":2 There is no \"lsten\"."));
  CHECK(refusal({"--data", "a\nworkers = 9"}).starts_with("--data takes no control characters."));
  CHECK(parse({"--config", "/nonexistent"}).error().code == ErrorCode::io);
}

TEST_CASE("a variable that means nothing is noticed, those of others are not") {
  const auto settings = parse(
      {"--data", "d"}, {"FAIRWAY_WORKRES=2", "FAIRWAY_SHARED=/x", "FAIRWAY_API_KEY=k", "PATH=/bin",
                        "FAIRWAY=1", "FAIRWAY_KILL_AT=file.rename", "FAIRWAY_STOP_AT=file.rename"});
  REQUIRE(settings);
  CHECK(settings->unknown_variables == std::vector<std::string>{"FAIRWAY_WORKRES"});
}

TEST_CASE("help lists every setting with its default") {
  const std::string help = usage_text();
  for (const SettingRow& row : setting_rows()) {
    CAPTURE(row.name);
    CHECK(help.find(flag_of(row) + " ") != std::string::npos);
    CHECK(help.find(text_of(Settings(), row)) != std::string::npos);
  }
}

TEST_CASE("help and version need nothing else") {
  CHECK(parse({"--help"})->help);
  CHECK(parse({"--version"})->version);
}
