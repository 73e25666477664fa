#include "server/fairwayd/http/trace.h"

#include <algorithm>

#include "server/os/random_id.h"

namespace fairway {
namespace {

constexpr std::size_t kTraceDigits = 32;
constexpr std::size_t kSpanDigits = 16;
constexpr std::size_t kVersion00Length = 55;  ///< 2 + 1 + 32 + 1 + 16 + 1 + 2

bool is_hexadecimal(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

bool is_id(std::string_view text) {
  return is_hexadecimal(text) && text.find_first_not_of('0') != std::string_view::npos;
}

/// Zeros are no id.
std::string new_id(std::size_t digits) {
  while (true) {
    std::string id = random_hexadecimal(digits / 2);
    if (is_id(id)) return id;
  }
}

}  // namespace

std::optional<TraceContext> parse_traceparent(std::string_view header) {
  if (header.size() < kVersion00Length) return std::nullopt;
  const std::string_view version = header.substr(0, 2);
  const std::string_view trace = header.substr(3, kTraceDigits);
  const std::string_view span = header.substr(36, kSpanDigits);
  const std::string_view flags = header.substr(53, 2);
  const bool parted = header[2] == '-' && header[35] == '-' && header[52] == '-';
  if (!parted || !is_hexadecimal(version) || version == "ff") return std::nullopt;
  const bool longer = header.size() > kVersion00Length;
  if (longer && (version == "00" || header[kVersion00Length] != '-')) return std::nullopt;
  if (!is_id(trace) || !is_id(span) || !is_hexadecimal(flags)) return std::nullopt;
  // Of the flags only the last bit has a meaning that may be passed on.
  const bool sampled = std::string_view("13579bdf").find(flags[1]) != std::string_view::npos;
  return TraceContext{std::string(trace), std::string(span), sampled};
}

std::string format_traceparent(const TraceContext& context) {
  return "00-" + context.trace_id + "-" + context.span_id + (context.sampled ? "-01" : "-00");
}

TraceContext trace_of(const NameValues& headers) {
  std::optional<TraceContext> context;
  std::size_t count = 0;
  for (const auto& [name, value] : headers) {
    if (name != "traceparent") continue;
    context = parse_traceparent(value);
    ++count;
  }
  if (!context || count != 1) context = TraceContext{new_id(kTraceDigits), {}, false};
  context->span_id = new_id(kSpanDigits);
  return *std::move(context);
}

}  // namespace fairway
