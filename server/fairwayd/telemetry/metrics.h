#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace fairway {

/// One metric of the Prometheus text format 0.0.4: a name, a help text, and a series of numbers for
/// each combination of label values. Label values are chosen by the server, never by a client, so
/// that there are few. Any thread may call; counts are kept in double, exact up to 2^53.
class MetricFamily {
 public:
  enum class Kind { counter, gauge, histogram };
  struct Shape {
    Kind kind = Kind::counter;
    std::string name;
    std::string help;
    std::vector<std::string> labels;  ///< names
    std::vector<double> bounds;       ///< of a histogram's buckets, rising; +Inf is added
  };
  using Values = std::vector<std::string>;  ///< of the labels, in their order

  explicit MetricFamily(Shape shape) : shape_(std::move(shape)) {}

  /// Counters and gauges; a counter is never lowered.
  void add(double by, const Values& values = {});
  /// Gauges.
  void set(double to, const Values& values = {});
  /// Histograms.
  void observe(double value, const Values& values = {});

  /// Lines # HELP, # TYPE and one for each number; a family that counted nothing has no number.
  std::string text() const;

 private:
  struct Series {
    double value = 0.0;                  ///< of a histogram: the sum
    std::vector<std::uint64_t> buckets;  ///< each for itself, +Inf last
  };

  Series& series(const Values& values);
  void write_histogram(const Values& values, const Series& series, std::string& to) const;
  std::string labels(const Values& values, std::string_view last_name = {},
                     std::string_view last_value = {}) const;

  const Shape shape_;

  mutable std::mutex mutex_;
  std::map<Values, Series> series_;
};

inline constexpr std::string_view kMetricsMediaType = "text/plain; version=0.0.4; charset=utf-8";

}  // namespace fairway
