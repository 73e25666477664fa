#include "server/fairwayd/telemetry/metrics.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace fairway {
namespace {

std::string number_text(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  return fmt::format("{}", value);
}

/// Help texts keep their quotes, label values do not.
std::string escaped(std::string_view text, bool quotes) {
  std::string result;
  for (const char c : text) {
    if (c == '\n') {
      result += "\\n";
    } else if (c == '\\' || (quotes && c == '"')) {
      result += '\\';
      result += c;
    } else {
      result += c;
    }
  }
  return result;
}

std::string_view name_of(MetricFamily::Kind kind) {
  switch (kind) {
    case MetricFamily::Kind::counter:
      return "counter";
    case MetricFamily::Kind::gauge:
      return "gauge";
    case MetricFamily::Kind::histogram:
      return "histogram";
  }
  return "untyped";
}

}  // namespace

MetricFamily::Series& MetricFamily::series(const Values& values) {
  Series& found = series_[values];
  if (found.buckets.empty()) found.buckets.resize(shape_.bounds.size() + 1);
  return found;
}

void MetricFamily::add(double by, const Values& values) {
  const std::lock_guard lock(mutex_);
  series(values).value += by;
}

void MetricFamily::set(double to, const Values& values) {
  const std::lock_guard lock(mutex_);
  series(values).value = to;
}

void MetricFamily::observe(double value, const Values& values) {
  const std::lock_guard lock(mutex_);
  Series& found = series(values);
  found.value += value;
  const auto bound = std::lower_bound(shape_.bounds.begin(), shape_.bounds.end(), value);
  ++found.buckets[static_cast<std::size_t>(bound - shape_.bounds.begin())];
}

std::string MetricFamily::text() const {
  std::string text = fmt::format("# HELP {} {}\n# TYPE {} {}\n", shape_.name,
                                 escaped(shape_.help, false), shape_.name, name_of(shape_.kind));
  const std::lock_guard lock(mutex_);
  for (const auto& [values, series] : series_) {
    if (shape_.kind == Kind::histogram) {
      write_histogram(values, series, text);
    } else {
      text += fmt::format("{}{} {}\n", shape_.name, labels(values), number_text(series.value));
    }
  }
  return text;
}

/// Buckets are told cumulatively.
void MetricFamily::write_histogram(const Values& values, const Series& series,
                                   std::string& to) const {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < series.buckets.size(); ++i) {
    count += series.buckets[i];
    const std::string bound = i < shape_.bounds.size() ? number_text(shape_.bounds[i]) : "+Inf";
    to += fmt::format("{}_bucket{} {}\n", shape_.name, labels(values, "le", bound), count);
  }
  to += fmt::format("{}_sum{} {}\n", shape_.name, labels(values), number_text(series.value));
  to += fmt::format("{}_count{} {}\n", shape_.name, labels(values), count);
}

std::string MetricFamily::labels(const Values& values, std::string_view last_name,
                                 std::string_view last_value) const {
  std::string text;
  const auto append = [&text](std::string_view name, std::string_view value) {
    text += fmt::format("{}{}=\"{}\"", text.empty() ? "" : ",", name, escaped(value, true));
  };
  for (std::size_t i = 0; i < std::min(values.size(), shape_.labels.size()); ++i) {
    append(shape_.labels[i], values[i]);
  }
  if (!last_name.empty()) append(last_name, last_value);
  return text.empty() ? text : "{" + text + "}";
}

}  // namespace fairway
