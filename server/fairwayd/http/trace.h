#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// Reads a `traceparent` header (W3C Trace Context, level 1), to the letter: lower-case hexadecimal
/// digits, no id of zeros, version 00 of exact length; of later versions the part that is known.
/// Nothing where it is not one.
std::optional<TraceContext> parse_traceparent(std::string_view header);

/// The header of a context: "00-<trace>-<span>-<flags>".
std::string format_traceparent(const TraceContext& context);

/// The context of an answer: the trace that the request's one valid `traceparent` names, or else
/// a new one; with a new span.
TraceContext trace_of(const NameValues& headers);

}  // namespace fairway
