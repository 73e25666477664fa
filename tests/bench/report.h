#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace fairway::bench {

struct Settings {
  bool json = false;
  unsigned threads = 1;
  std::string isa;
  double noise = 0.1;               ///< in mean edges: the more, the more edges are strong
  std::vector<std::string> stages;  ///< those wanted; all if empty
  std::vector<std::size_t> sizes = {4'000, 35'000, 130'000, 500'000, 1'600'000};
};

double seconds_of(const std::function<void()>& work);

/// The least times of ours and of the baseline, seconds; 0 where there is no baseline.
struct Times {
  double ours = 0.0;
  double baseline = 0.0;
};

/// The least of a few runs each, in turn, so that both see the same weather.
Times in_turn(int runs, const std::function<void()>& ours, const std::function<void()>& baseline);

struct Case {
  std::string name;
  std::size_t vertices = 0;
  std::string order;
  double bytes_per_vertex = 0.0;
};

/// A table on the terminal, or a JSON line per case.
class Report {
 public:
  explicit Report(const Settings& settings);
  void line(const Case& c, const Times& times) const;

 private:
  const Settings& settings_;
};

}  // namespace fairway::bench
