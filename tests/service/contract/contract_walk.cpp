#include "tests/service/contract/contract_walk.h"

#include <algorithm>
#include <cctype>

#include <catch2/catch.hpp>

#include "tests/messages/json_schema.h"
#include "tests/service/support/event_text.h"

namespace fairway::test {
namespace {

/// Headers of the message itself, which need no document.
const std::set<std::string> kFraming = {"content-type", "content-length", "connection",
                                        "keep-alive", "transfer-encoding"};

constexpr const char* kMethods[] = {"options", "head", "get", "post", "put", "patch", "delete"};

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_json(const std::string& media_type) {
  return media_type == "application/json" || media_type == "application/problem+json";
}

std::string key_of(const std::string& status, const std::string& name) {
  return name.empty() ? status : status + " " + name;
}

Operation operation_at(const Json& document, const std::string& path, const std::string& method) {
  const Json& item = document["paths"][path];
  const Json& from = item[method];
  Operation operation{from["operationId"], upper(method),  path,  "",
                      Json::array(),       Json::object(), Json()};
  if (from.contains("security")) {
    REQUIRE(document["components"]["securitySchemes"]["key"]["scheme"] == "bearer");
    operation.scope = from["security"][0]["key"][0];
  }
  if (from.contains("requestBody")) operation.body = resolved(document, from["requestBody"]);
  for (const Json* list : {&item, &from}) {
    if (!list->contains("parameters")) continue;
    for (const Json& one : (*list)["parameters"]) {
      operation.parameters.push_back(resolved(document, one));
    }
  }
  for (const auto& [status, response] : from["responses"].items()) {
    operation.responses[status] = resolved(document, response);
  }
  return operation;
}

}  // namespace

Json resolved(const Json& document, const Json& value) {
  if (!value.is_object() || !value.contains("$ref")) return value;
  const std::string target = value["$ref"];
  REQUIRE(target.starts_with("#/"));
  const Json::json_pointer pointer(target.substr(1));
  CAPTURE(target);
  REQUIRE(document.contains(pointer));
  return resolved(document, document.at(pointer));
}

std::vector<Operation> operations_of(const Json& document) {
  std::vector<Operation> out;
  for (const auto& [path, item] : document["paths"].items()) {
    for (const char* method : kMethods) {
      if (item.contains(method)) out.push_back(operation_at(document, path, method));
    }
  }
  return out;
}

std::string filled(std::string_view path, const std::string& id) {
  std::string out(path);
  for (std::size_t at = out.find('{'); at != std::string::npos; at = out.find('{')) {
    out.replace(at, out.find('}') + 1 - at, id);
  }
  return out;
}

std::string path_with(const Operation& operation, const std::string& id) {
  return filled(operation.path, id);
}

std::string name_of_value(const Json& value) {
  for (const char* key : {"code", "state", "status"}) {
    if (value.is_object() && value.contains(key) && value[key].is_string()) return value[key];
  }
  return {};
}

ContractWalk::ContractWalk(const Json& document, const std::string& operation_id)
    : document_(document) {
  const auto all = operations_of(document);
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const Operation& one) { return one.id == operation_id; });
  CAPTURE(operation_id);
  REQUIRE(found != all.end());
  operation_ = *found;
}

void ContractWalk::see(const Answer& answer) {
  const std::string status = std::to_string(answer.status);
  const std::string shown = answer.body.substr(0, 300);
  CAPTURE(operation_.id, status, shown);
  if (!operation_.responses.contains(status)) {
    FAIL_CHECK("an undocumented status came");
    return;
  }
  const Json& response = operation_.responses[status];
  check_headers(response, answer);
  check_body(response, answer);
  note(answer, "");
}

void ContractWalk::note(const Answer& answer, const std::string& name) {
  seen_.insert(key_of(std::to_string(answer.status), name));
}

void ContractWalk::check_fits(const Json& value, const Json& schema) const {
  const std::string fault = schema_fault(value, schema, document_);
  CAPTURE(fault);
  CHECK(fault.empty());
}

void ContractWalk::check_headers(const Json& response, const Answer& answer) const {
  std::set<std::string> documented = kFraming;
  const Json headers = response.value("headers", Json::object());
  for (const auto& [name, given] : headers.items()) {
    const Json header = resolved(document_, given);
    CAPTURE(name);
    documented.insert(lower(name));
    const auto found = answer.headers.find(lower(name));
    if (found != answer.headers.end()) {
      check_fits(found->second, header["schema"]);
    } else {
      CHECK_FALSE(header.value("required", false));
    }
  }
  for (const auto& [name, value] : answer.headers) {
    CAPTURE(name, value);
    if (!documented.contains(name)) FAIL_CHECK("an undocumented header came");
  }
}

void ContractWalk::check_body(const Json& response, const Answer& answer) {
  const std::string type = answer.header("content-type");
  const std::string media_type = type.substr(0, type.find(';'));
  CAPTURE(media_type);
  const Json content = response.value("content", Json::object());
  if (content.contains("*/*")) {  // of any type
    CHECK_FALSE(media_type.empty());
    note(answer, "*/*");
    return;
  }
  if (content.empty()) {
    CHECK(media_type.empty());
    CHECK(answer.body.empty());
    return;
  }
  if (!content.contains(media_type)) {
    FAIL_CHECK("an undocumented media type came");
    return;
  }
  // What was refused before it was understood has a body, whatever its method.
  if (operation_.method == "HEAD" && answer.body.empty()) return;
  CHECK_FALSE(answer.body.empty());
  note(answer, media_type);
  const Json& media = content[media_type];
  if (is_json(media_type)) check_json(media, answer, media_type);
  if (media.contains("x-events")) check_events(media, answer);
  if (media_type.starts_with("text/")) check_fits(answer.body, media["schema"]);
}

void ContractWalk::check_json(const Json& media, const Answer& answer,
                              const std::string& media_type) {
  const Json body = answer.json();
  check_fits(body, media["schema"]);
  if (media_type == "application/problem+json") check_problem(media, body);
  note(answer, name_of_value(body));
}

void ContractWalk::check_problem(const Json& media, const Json& body) const {
  const std::string name = name_of_value(body);
  CAPTURE(name);
  if (!media["examples"].contains(name)) {
    FAIL_CHECK("an undocumented problem came");
    return;
  }
  const Json example = resolved(document_, media["examples"][name])["value"];
  for (const char* same : {"type", "title", "status", "code"}) CHECK(body[same] == example[same]);
}

void ContractWalk::check_events(const Json& media, const Answer& answer) {
  for (const Event& event : events_of(answer.body)) {
    CAPTURE(event.name);
    if (!media["x-events"].contains(event.name)) {
      FAIL_CHECK("an undocumented event came");
      continue;
    }
    check_fits(event.data, media["x-events"][event.name]);
    note(answer, event.name);
  }
}

std::set<std::string> ContractWalk::missing() const {
  std::set<std::string> out;
  for (const auto& [status, response] : operation_.responses.items()) {
    out.insert(status);
    if (operation_.method == "HEAD") continue;  // its answers have no bodies
    const Json content = response.value("content", Json::object());
    for (const auto& [type, media] : content.items()) {
      out.insert(key_of(status, type));
      const Json events = media.value("x-events", Json::object());
      for (const auto& [name, schema] : events.items()) out.insert(key_of(status, name));
      const Json examples = media.value("examples", Json::object());
      for (const auto& [name, example] : examples.items()) {
        const Json value = resolved(document_, example)["value"];
        out.insert(key_of(status, name_of_value(value)));
      }
    }
  }
  for (const std::string& seen : seen_) out.erase(seen);
  return out;
}

}  // namespace fairway::test
