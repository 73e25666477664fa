// The readers of JSON documents.

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "proto/messages/parameters.h"
#include "proto/messages/problem.h"
#include "proto/messages/worker_protocol.h"
#include "tests/fuzz/targets.h"

namespace fairway::test {
namespace {

std::string refusal_defect(const Error& error, std::span<const ErrorCode> may) {
  if (std::find(may.begin(), may.end(), error.code) == may.end()) {
    return fmt::format("refused with {}: {}", problem_kind(error.code).slug, error.message);
  }
  return error.message.size() < 10 ? "refused without a sentence" : "";
}

std::string line_defect(std::string_view line) {
  if (line.empty() || line.back() != '\n') return "a line has no end";
  return line.find('\n') + 1 == line.size() ? "" : "a line has two ends";
}

/// `format_line` and `parse` undo each other.
template <class Value, class Parse>
std::string protocol_defect(ByteSpan bytes, Parse parse) {
  constexpr std::array<ErrorCode, 3> kMay = {
      ErrorCode::malformed_input, ErrorCode::malformed_parameters, ErrorCode::invalid_parameters};
  const Result<Value> value = parse(as_text(bytes));
  if (!value) return refusal_defect(value.error(), kMay);
  const std::string line = format_line(*value);
  if (auto defect = line_defect(line); !defect.empty()) return defect;
  const Result<Value> again = parse(std::string_view(line).substr(0, line.size() - 1));
  if (!again) return "an own line does not read: " + again.error().message;
  return format_line(*again) == line ? "" : "an own line reads as something else";
}

}  // namespace

std::string fuzz_parameters(ByteSpan bytes) {
  constexpr std::array<ErrorCode, 2> kMay = {ErrorCode::malformed_parameters,
                                             ErrorCode::invalid_parameters};
  const auto parameters = parse_parameters(as_text(bytes));
  if (!parameters) return refusal_defect(parameters.error(), kMay);
  const std::string stated = dump_json(parameters_document(*parameters));
  const auto again = parse_parameters(stated);
  if (!again) return "own parameters are refused: " + again.error().message;
  return dump_json(parameters_document(*again)) == stated ? "" : "own parameters read as others";
}

std::string fuzz_worker_order(ByteSpan bytes) {
  return protocol_defect<WorkerOrder>(bytes, parse_worker_order);
}

std::string fuzz_worker_event(ByteSpan bytes) {
  return protocol_defect<WorkerEvent>(bytes, parse_worker_event);
}

}  // namespace fairway::test
