// `fairway methods`, as a person runs it.

#include <catch2/catch.hpp>

#include "proto/messages/method_catalog.h"
#include "proto/messages/parameter_schema.h"
#include "proto/messages/presets.h"
#include "tests/tool/run_tool.h"

namespace fairway::test {

TEST_CASE("the methods as JSON are the document of the service") {
  const ToolRun run = run_tool({"methods", "--json"});
  REQUIRE(run.exit_code == 0);
  const auto document = parse_json(run.output);
  REQUIRE(document);
  CHECK(*document == methods_document());
}

TEST_CASE("the tables of the methods name every flow, preset and parameter") {
  const ToolRun run = run_tool({"methods"});
  REQUIRE(run.exit_code == 0);
  const auto tells = [&](std::string_view text) {
    CAPTURE(text);
    CHECK(run.output.find(text) != std::string::npos);
  };
  for (const MethodText& method : method_texts()) {
    tells(method.name);
    tells(method.equation);
  }
  for (const Preset preset : kPresets) tells(description_of(preset));
  for (const ParameterText& text : parameter_texts()) {
    tells(text.path);
    tells(text.text);
  }
  tells("  steps: 0 to 10000, auto (steps); default auto\n");
  tells("  guards/min_component: 0 to 1000000, false (vertices); default 12\n");
}

}  // namespace fairway::test
