// Lines between fairwayd and its workers.

#include "proto/messages/worker_protocol.h"

#include <utility>

#include "proto/messages/bundle.h"

namespace fairway {
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

Error not_an_event(std::string what) {
  return {ErrorCode::malformed_input, std::move(what)};
}

std::string text_of(const Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_string() ? it->get<std::string>() : std::string();
}

double number_of(const Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_number() ? it->get<double>() : 0.0;
}

int count_of(const Json& json, const char* key) {
  const double value = number_of(json, key);
  return value >= 0.0 && value <= 1e9 ? static_cast<int>(value) : 0;
}

}  // namespace

std::string format_line(const WorkerOrder& order) {
  Json json = {{"input", name_of(order.input)},
               {"parameters", parameters_document(order.parameters)}};
  if (order.files > 1) json["files"] = order.files;
  if (order.work == Work::inspect) json["work"] = "inspect";
  if (!order.trace.empty()) json["trace"] = order.trace;
  return dump_json(json) + "\n";
}

Result<WorkerOrder> parse_worker_order(std::string_view line) {
  Result<Json> json = parse_json(line);
  if (!json) return json.error();
  if (!json->is_object() || !json->contains("parameters")) {
    return not_an_event("The order is not an object with parameters.");
  }
  const std::optional<Format> input = format_of_name(text_of(*json, "input"));
  if (!input) return not_an_event("The order names no input format.");
  Result<Parameters> parameters = parse_parameters(dump_json((*json)["parameters"]));
  if (!parameters) return parameters.error();
  const Json files = json->value("files", Json(1U));
  if (!files.is_number_unsigned() || files < 1U || files > kMaxBundleFiles) {
    return not_an_event("The order names no number of files.");
  }
  const Json work = json->value("work", Json("denoise"));
  if (work != "denoise" && work != "inspect") return not_an_event("The order names no work.");
  return WorkerOrder{*input, *std::move(parameters), files.get<std::size_t>(),
                     work == "inspect" ? Work::inspect : Work::denoise, text_of(*json, "trace")};
}

std::string format_line(const WorkerEvent& event) {
  const Json json = std::visit(
      Overloaded{
          [](const Progress& p) -> Json {
            return {{"event", "progress"},
                    {"stage", p.stage},
                    {"step", p.step},
                    {"of", p.of},
                    {"fraction", p.fraction}};
          },
          [](const Finished& f) -> Json {
            return {{"event", "finished"}, {"output", name_of(f.output)}, {"report", f.report}};
          },
          [](const Failed& f) -> Json {
            return {{"event", "failed"}, {"problem", problem_document(f.error)}};
          }},
      event);
  return dump_json(json) + "\n";
}

Result<WorkerEvent> parse_worker_event(std::string_view line) {
  Result<Json> json = parse_json(line);
  if (!json) return json.error();
  if (!json->is_object()) return not_an_event("An event is a JSON object.");
  const std::string event = text_of(*json, "event");
  if (event == "progress") {
    return WorkerEvent(Progress{text_of(*json, "stage"), count_of(*json, "step"),
                                count_of(*json, "of"), number_of(*json, "fraction")});
  }
  if (event == "finished") {
    const std::optional<Format> output = format_of_name(text_of(*json, "output"));
    if (!output || !json->contains("report")) return not_an_event("The result is not described.");
    return WorkerEvent(Finished{*output, (*json)["report"]});
  }
  if (event == "failed" && json->contains("problem")) {
    return WorkerEvent(Failed{error_of_problem((*json)["problem"])});
  }
  return not_an_event("This event is not known.");
}

}  // namespace fairway
