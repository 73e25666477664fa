#include "server/fairwayd/http/trace.h"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

const std::string kTrace = "0af7651916cd43dd8448eb211c80319c";
const std::string kSpan = "b7ad6b7169203331";
const std::string kHeader = "00-" + kTrace + "-" + kSpan + "-01";

}  // namespace

TEST_CASE("a traceparent is read to its parts") {
  const auto context = parse_traceparent(kHeader);
  REQUIRE(context);
  CHECK(context->trace_id == kTrace);
  CHECK(context->span_id == kSpan);
  CHECK(context->sampled);
  CHECK(format_traceparent(*context) == kHeader);
  CHECK_FALSE(parse_traceparent("00-" + kTrace + "-" + kSpan + "-02")->sampled);
  CHECK(parse_traceparent("00-" + kTrace + "-" + kSpan + "-ff")->sampled);
}

TEST_CASE("a traceparent of a later version is read as far as it is known") {
  CHECK(parse_traceparent("cc" + kHeader.substr(2)));
  CHECK(parse_traceparent("cc" + kHeader.substr(2) + "-what-comes-then"));
  CHECK_FALSE(parse_traceparent("cc" + kHeader.substr(2) + ".what"));
  CHECK_FALSE(parse_traceparent("ff" + kHeader.substr(2)));
}

TEST_CASE("what is no traceparent to the letter is none") {
  std::vector<std::string> broken = {
      "",
      "00",
      kHeader + "-",
      kHeader + " ",
      " " + kHeader,
      kHeader + "-00",
      "00-" + std::string(32, '0') + "-" + kSpan + "-01",
      "00-" + kTrace + "-" + std::string(16, '0') + "-01",
      "00-" + kTrace + "-" + kSpan + "-0x",
      "0X-" + kTrace + "-" + kSpan + "-01",
      "00-0AF7651916cd43dd8448eb211c80319c-" + kSpan + "-01",
      "00-" + kTrace + "-b7ad6b716920333g-01",
  };
  for (std::size_t i = 0; i < kHeader.size(); ++i) {
    broken.push_back(kHeader.substr(0, i));
    broken.push_back(kHeader);
    broken.back()[i] = ' ';
  }
  for (const std::string& header : broken) {
    CAPTURE(header);
    CHECK_FALSE(parse_traceparent(header));
  }
}

TEST_CASE("a request goes on with its trace, in a span of its own") {
  const TraceContext context = trace_of({{"accept", "x"}, {"traceparent", kHeader}});
  CHECK(context.trace_id == kTrace);
  CHECK(context.sampled);
  CHECK(context.span_id != kSpan);
  CHECK(parse_traceparent(format_traceparent(context)));
}

TEST_CASE("a request with no traceparent, a broken one or two begins a trace") {
  for (const NameValues& headers :
       {NameValues{}, NameValues{{"traceparent", "00-" + kTrace}},
        NameValues{{"traceparent", kHeader}, {"traceparent", kHeader}}}) {
    const TraceContext context = trace_of(headers);
    CHECK(context.trace_id != kTrace);
    CHECK_FALSE(context.sampled);
    CHECK(parse_traceparent(format_traceparent(context)));
    CHECK(trace_of(headers).trace_id != context.trace_id);
  }
}
