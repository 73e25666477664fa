// The sandbox of the worker, by its self-test: with walls, and without any.
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "tests/tool/run_tool.h"

using namespace fairway::test;

namespace {

/// The lines that begin so.
std::vector<std::string> lines_with(const std::string& text, const std::string& beginning) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(beginning)) found.push_back(line);
  }
  return found;
}

}  // namespace

TEST_CASE("every forbidden call ends a confined process, and its work goes on") {
  const ToolRun run = run_tool({"worker", "--self-test-sandbox"});
  INFO(run.output);
  CHECK(run.exit_code == 0);
  CHECK(lines_with(run.output, "FAILED").empty());
  CHECK(lines_with(run.output, "note   workers").size() == 1);
  CHECK(lines_with(run.output, "ok     allowed").size() == 4);
#ifndef FAIRWAY_SANITIZED
  const auto forbidden = lines_with(run.output, "ok     forbidden");
  CHECK(forbidden.size() == 16);
  for (const std::string& line : forbidden) CHECK(line.ends_with("forbidden system call"));
#else
  CHECK(lines_with(run.output, "note   this build has sanitizers").size() == 1);
#endif
}

TEST_CASE("without the walls the same calls end nothing and succeed, and the self-test fails") {
  const ToolRun run = run_tool({"worker", "--self-test-unconfined"});
  INFO(run.output);
  CHECK(run.exit_code > 0);
  CHECK(lines_with(run.output, "FAILED forbidden").size() == 16);
  CHECK(run.output.find("forbidden system call") == std::string::npos);
  // The others may be refused by what this test runs in.
  for (const char* call :
       {"open a file", "look whether a file is there", "make a socket", "connect",
        "execute a program", "fork ", "prctl", "map memory as code", "make memory code",
        "signal another process", "copy a descriptor", "touch its limits"}) {
    CAPTURE(call);
    const auto lines = lines_with(run.output, std::string("FAILED forbidden ") + call);
    REQUIRE_FALSE(lines.empty());
    CHECK(lines.front().ends_with("succeeded"));
  }
  CHECK(lines_with(run.output, "ok     allowed").size() == 4);
}
