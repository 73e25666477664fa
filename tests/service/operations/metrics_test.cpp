#include "server/fairwayd/telemetry/metrics.h"

#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include "server/fairwayd/telemetry/stage_clock.h"
#include "server/fairwayd/work/service_metrics.h"

using namespace fairway;
using namespace std::chrono_literals;
using Kind = MetricFamily::Kind;

TEST_CASE("a counter and a gauge tell a number for each set of labels") {
  MetricFamily family({Kind::counter, "a_total", "What it counts.", {"x", "y"}, {}});
  family.add(1, {"1", "b"});
  family.add(2.5, {"1", "b"});
  family.add(1, {"0", "c"});
  CHECK(family.text() ==
        "# HELP a_total What it counts.\n# TYPE a_total counter\n"
        "a_total{x=\"0\",y=\"c\"} 1\na_total{x=\"1\",y=\"b\"} 3.5\n");
  MetricFamily gauge({Kind::gauge, "g", "Now.", {}, {}});
  gauge.set(7);
  gauge.add(-3);
  CHECK(gauge.text() == "# HELP g Now.\n# TYPE g gauge\ng 4\n");
}

TEST_CASE("a histogram tells cumulative buckets up to +Inf, the sum and the count") {
  MetricFamily family({Kind::histogram, "h", "Times.", {"s"}, {0.5, 1, 2}});
  for (const double value : {0.25, 0.5, 0.75, 2.0, 8.0}) family.observe(value, {"a"});
  CHECK(family.text() ==
        "# HELP h Times.\n# TYPE h histogram\n"
        "h_bucket{s=\"a\",le=\"0.5\"} 2\n"
        "h_bucket{s=\"a\",le=\"1\"} 3\n"
        "h_bucket{s=\"a\",le=\"2\"} 4\n"
        "h_bucket{s=\"a\",le=\"+Inf\"} 5\n"
        "h_sum{s=\"a\"} 11.5\nh_count{s=\"a\"} 5\n");
}

TEST_CASE("labels and help texts cannot break their line") {
  MetricFamily family({Kind::gauge, "g", "A \\ and a\nline \"end\".", {"x"}, {}});
  family.set(1, {"a\"b\\c\nd"});
  CHECK(family.text() ==
        "# HELP g A \\\\ and a\\nline \"end\".\n# TYPE g gauge\ng{x=\"a\\\"b\\\\c\\nd\"} 1\n");
}

TEST_CASE("threads lose no count") {
  MetricFamily family({Kind::counter, "c_total", "Counts.", {}, {}});
  {
    std::vector<std::jthread> threads;
    threads.reserve(4);
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] {
        for (int k = 0; k < 1000; ++k) family.add(1);
      });
    }
  }
  CHECK(family.text().ends_with("c_total 4000\n"));
}

TEST_CASE("a method that a client invents makes no series of its own") {
  ServiceMetrics metrics("1");
  for (const char* method : {"GET", "BREW", "get", "X\"}"}) {
    HttpExchange exchange;
    exchange.method = method;
    exchange.status = 204;
    metrics.answered(exchange, "/livez");
  }
  const std::string text = metrics.text({}, 0, {});
  CHECK(text.find("{route=\"/livez\",method=\"GET\",status=\"2xx\"} 1\n") != std::string::npos);
  CHECK(text.find("{route=\"/livez\",method=\"other\",status=\"2xx\"} 3\n") != std::string::npos);
}

TEST_CASE("the age of the queue is that of its oldest job, and never negative") {
  ServiceMetrics metrics("1");
  const auto age = [&](std::optional<UnixMillis> oldest) {
    const std::string text = metrics.text(JobCounts{{{JobState::queued, 2}}, oldest}, 10'000, {});
    const std::string name = "\nfairway_queue_oldest_age_seconds ";
    const std::size_t at = text.find(name);
    REQUIRE(at != std::string::npos);
    CHECK(text.find("\nfairway_queue_depth 2\n") != std::string::npos);
    return std::stod(text.substr(at + name.size()));
  };
  CHECK(age(7'500) == 2.5);
  CHECK(age({}) == 0.0);
  CHECK(age(11'000) == 0.0);
}

TEST_CASE("stages that come again are continued, and unknown ones are one") {
  StageClock clock;
  const StageClock::Clock::time_point start{};
  clock.enter("decode", start);
  clock.enter("flow", start + 1ms);
  clock.enter("flow", start + 2ms);
  clock.enter("curvature", start + 4ms);
  clock.enter("flow", start + 5ms);
  clock.enter("}x", start + 7ms);
  const StageTimes times = clock.finish(start + 17ms);
  CHECK(times == StageTimes{{"decode", 1ms}, {"flow", 5ms}, {"curvature", 1ms}, {"other", 10ms}});
  CHECK(clock.finish(start + 30ms) == times);
  CHECK(StageClock().finish().empty());
}
