// The contract against the service: proto/openapi.yaml as it is served.

#include "proto/messages/openapi.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include <catch2/catch.hpp>

#include "proto/messages/job_options.h"
#include "proto/messages/parameters.h"
#include "proto/messages/problem.h"
#include "server/fairwayd/api/routes.h"
#include "tests/messages/json_schema.h"
#include "tests/service/contract/contract_walks.h"

namespace fairway::test {
namespace {

const std::set<std::string> kTags = {"Denoise",  "Jobs",  "Uploads",  "Inspect",
                                     "Contract", "Pages", "Operation"};

/// The methods of an Allow header, without HEAD where it stands beside GET: there it is not
/// documented.
std::set<std::string> methods_in(std::string_view list) {
  std::set<std::string> out;
  while (!list.empty()) {
    const std::size_t comma = list.find(", ");
    out.emplace(list.substr(0, comma));
    list = comma == std::string_view::npos ? std::string_view() : list.substr(comma + 2);
  }
  if (out.contains("GET")) out.erase("HEAD");
  return out;
}

std::set<std::string> ids_of(const Json& document) {
  std::set<std::string> out;
  for (const Operation& operation : operations_of(document)) out.insert(operation.id);
  return out;
}

bool has_tag(const Json& document, const Operation& operation, const std::string& tag) {
  std::string method = operation.method;
  for (char& c : method) c = static_cast<char>(c - 'A' + 'a');
  return document["paths"][operation.path][method]["tags"] == Json::array({tag});
}

Json served_document() {
  const Stage stage;
  const Answer answer = stage.client().get("/openapi.json");
  REQUIRE(answer.status == 200);
  return answer.json();
}

void check_complete(const ContractWalk& walk) {
  std::set<std::string> missing = walk.missing();
#ifdef FAIRWAY_SANITIZED
  missing.erase("422 memory_limit");
#endif
  CAPTURE(walk.operation().id, missing);
  CHECK(missing.empty());
}

/// Walks all operations of a tag. What takes long by itself begins before the walks.
void walk_tag(const std::string& tag) {
  const Json document = served_document();
  std::vector<ContractWalk> walks;
  for (const Operation& operation : operations_of(document)) {
    if (has_tag(document, operation, tag)) walks.emplace_back(document, operation.id);
  }
  REQUIRE_FALSE(walks.empty());
  const Stage stage;
  std::vector<SlowRequests> slow;
  slow.reserve(walks.size());
  for (const ContractWalk& walk : walks) slow.emplace_back(walk.operation(), stage.service.port());
  for (ContractWalk& walk : walks) {
    const std::string& id = walk.operation().id;
    CAPTURE(id);
    REQUIRE(contract_walks().contains(id));
    contract_walks().at(id)(walk);
    see_keys_asked_for(walk);
    see_strange_pages(walk, stage);
  }
  for (std::size_t i = 0; i < walks.size(); ++i) slow[i].see(walks[i]);
  for (const ContractWalk& walk : walks) check_complete(walk);
}

void check_fits(const Json& value, const Json& schema, const Json& document) {
  const std::string fault = schema_fault(value, schema, document);
  CAPTURE(fault);
  CHECK(fault.empty());
}

/// Checks the examples of everything with a "schema" below a place of the document.
void check_examples(const Json& document, const Json& place, std::size_t& count) {
  if (!place.is_structured()) return;
  if (place.is_object() && place.contains("schema")) {
    if (place.contains("example")) {
      check_fits(place["example"], place["schema"], document);
      ++count;
    }
    const Json examples = place.value("examples", Json::object());
    for (const auto& [name, given] : examples.items()) {
      CAPTURE(name);
      const Json example = resolved(document, given);
      check_fits(example["value"], place["schema"], document);
      ++count;
    }
  }
  for (const Json& inner : place) check_examples(document, inner, count);
}

}  // namespace

TEST_CASE("every route is documented, and every documented operation has its route") {
  const Json document = openapi_document();
  std::map<std::string, std::set<std::string>> documented;
  for (const Operation& operation : operations_of(document)) {
    // OPTIONS is everywhere; it is documented where it tells more than the methods.
    if (operation.method == "OPTIONS") continue;
    CHECK(documented[operation.path].insert(operation.method).second);
  }
  std::map<std::string, std::set<std::string>> routes;
  for (const RoutePattern& route : route_patterns()) {
    routes[std::string(route.path)] = methods_in(route.methods);
    CAPTURE(route.path);
    CHECK((!methods_in(route.methods).contains("GET") ||
           route.methods.find("HEAD") != std::string_view::npos));
  }
  CHECK(documented == routes);
}

TEST_CASE("every operation has its walk, and every tag its test") {
  const Json document = openapi_document();
  std::set<std::string> walks;
  for (const auto& [id, walk] : contract_walks()) walks.insert(id);
  CHECK(walks == ids_of(document));
  CHECK(walks.size() == operations_of(document).size());
  std::set<std::string> tags;
  for (const Json& tag : document["tags"]) tags.insert(tag["name"]);
  CHECK(tags == kTags);
  for (const Operation& operation : operations_of(document)) {
    CAPTURE(operation.id);
    CHECK(std::any_of(kTags.begin(), kTags.end(),
                      [&](const std::string& tag) { return has_tag(document, operation, tag); }));
  }
}

TEST_CASE("every example of the document fits its schema") {
  const Json document = openapi_document();
  std::size_t count = 0;
  check_examples(document, document["paths"], count);
  check_examples(document, document["components"], count);
  check_examples(document, document["webhooks"], count);
  CHECK(count > 50);
  for (const auto& [name, example] : document["components"]["examples"].items()) {
    CAPTURE(name);
    if (name.starts_with("job_") && name != "job_list") {
      CHECK(parse_parameters(example["value"]["parameters"].dump()));
      CHECK(example["value"]["state"] == name.substr(4));
    }
  }
}

TEST_CASE("the options of a job are documented as they are read") {
  Json documented = openapi_document()["components"]["schemas"]["JobOptions"];
  documented.erase("description");
  for (Json& property : documented["properties"]) property.erase("description");
  CHECK(nlohmann::json(documented) == nlohmann::json(job_options_schema()));
}

TEST_CASE(
    "every problem that is answered over HTTP has its example, as the table of problems has it") {
  const Json examples = openapi_document()["components"]["examples"];
  const Json codes =
      openapi_document()["components"]["schemas"]["Problem"]["properties"]["code"]["enum"];
  for (int i = 0; i <= static_cast<int>(ErrorCode::internal); ++i) {
    const auto code = static_cast<ErrorCode>(i);
    // Of the command line; a service whose files fail is unavailable.
    if (code == ErrorCode::usage || code == ErrorCode::io) continue;
    const ProblemKind& kind = problem_kind(code);
    const std::string slug(kind.slug);
    CAPTURE(slug);
    REQUIRE(examples.contains(slug));
    const Json& example = examples[slug]["value"];
    const Json expected =
        problem_document({code, example["detail"], example.value("pointer", std::string())});
    CHECK(example == expected);
    CHECK(std::find(codes.begin(), codes.end(), slug) != codes.end());
  }
}

TEST_CASE("the contract that is served is that of the program, with the schema of the parameters") {
  const Stage stage;
  const Json served = stage.client().get("/openapi.json").json();
  CHECK(served == openapi_document());
  CHECK(served["openapi"] == "3.1.0");
  const Json methods = stage.client().get("/v1/methods").json();
  CHECK(served["components"]["schemas"]["Parameters"] == methods["parameters"]);
  CHECK(served["info"]["version"] == FAIRWAY_VERSION);
}

TEST_CASE("paths and methods that are not documented are answered 404 and 405 with Allow") {
  const Stage stage;
  const Json document = openapi_document();
  const auto problem = [&](const Answer& answer) {
    check_fits(answer.json(), document["components"]["schemas"]["Problem"], document);
    return answer.problem();
  };
  for (const char* path : {"/v1", "/v1/", "/v1/jobs/", "/v2/jobs", "/docs/", "/docs/a/b.js",
                           "/assets/", "/openapi.yaml", "/v1/methods/auto"}) {
    for (const char* method : {"GET", "POST", "PUT", "DELETE"}) {
      CAPTURE(path, method);
      const Answer answer = stage.ask({method, path, {}, ""});
      CHECK(answer.status == 404);
      CHECK(problem(answer) == "not_found");
    }
  }
  for (const RoutePattern& route : route_patterns()) {
    const std::string path = filled(route.path, kNobody);
    const std::string allow = stage.ask({"OPTIONS", path, {}, ""}).header("allow");
    CHECK(allow == std::string(route.methods) + ", OPTIONS");
    for (const char* method : {"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE"}) {
      if (is_allowed(route_of(path)->place, method)) continue;
      CAPTURE(path, method);
      const Answer answer = stage.ask({method, path, {}, ""});
      CHECK(answer.status == 405);
      CHECK(answer.header("allow") == allow);
      if (std::string(method) != "HEAD") CHECK(problem(answer) == "method_not_allowed");
    }
  }
}

TEST_CASE("a listener for administration has health and metrics, as the document says") {
  const Stage stage({"--admin-listen", "127.0.0.1:0"});
  const std::set<std::string> both = {"/livez", "/readyz"};
  for (const Operation& operation : operations_of(openapi_document())) {
    const std::string path = path_with(operation, kNobody);
    CAPTURE(operation.method, path);
    const bool here = both.contains(path) || path == "/metrics";
    const Answer answer = exchange(stage.service.admin_port(), {operation.method, path, {}, ""});
    CHECK((answer.status != 404) == here);
    if (!here && operation.method != "HEAD") CHECK(answer.problem() == "not_found");
    if (both.contains(path)) CHECK(stage.ask({operation.method, path, {}, ""}).status == 200);
  }
}

TEST_CASE("every documented answer of a denoising is given, and no other") {
  walk_tag("Denoise");
}
TEST_CASE("every documented answer about jobs is given, and no other") {
  walk_tag("Jobs");
}
TEST_CASE("every documented answer about uploads is given, and no other") {
  walk_tag("Uploads");
}
TEST_CASE("every documented answer of an inspection is given, and no other") {
  walk_tag("Inspect");
}
TEST_CASE("every documented answer about the contract is given, and no other") {
  walk_tag("Contract");
}
TEST_CASE("pages answer what is documented, all of it and nothing else") {
  walk_tag("Pages");
}

TEST_CASE("every documented answer about the operation is given, and no other") {
  walk_tag("Operation");
}

}  // namespace fairway::test
