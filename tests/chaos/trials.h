#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/broken.h"

namespace fairway::chaos {

using test::Broken;
using test::expect;
using test::milliseconds_since;

/// One quantity, measured many times, with the bound that it is promised to keep.
struct Measure {
  std::vector<double> values;
  double bound = 0.0;  ///< 0: none
  std::string unit;
};

struct Options {
  std::uint64_t seed = 1;
  double scale = 1.0;             ///< of every count
  double patience = 1.0;          ///< times every bound
  std::vector<std::string> only;  ///< scenarios; all where empty
};

/// Counts trials, says at once which of them broke, and keeps what they measured.
class Trials {
 public:
  explicit Trials(const Options& options) : options_(options), random_(options.seed) {}

  /// The scenario that the next trials belong to.
  void enter(std::string_view scenario);
  /// Runs one trial; false where it is broken. A trial that takes longer than a minute has its
  /// service killed.
  bool run(const std::string& name, const std::function<void()>& trial);

  /// `full` scaled, at least 1.
  std::size_t scaled(std::size_t full) const;
  /// A whole number from `low` to `high`, both included.
  std::size_t random(std::size_t low, std::size_t high);

  /// Records values; one above `bound` (where that is not 0) breaks the trial.
  void measure(const std::string& name, const std::vector<double>& values, const std::string& unit,
               double bound = 0.0);
  void measure(const std::string& name, double value, const std::string& unit, double bound = 0.0);
  /// Records a quantity without a bound on one value, such as a count.
  void note(const std::string& name, double value);

  std::size_t done() const { return done_; }
  std::size_t passed() const { return passed_; }
  /// Of one scenario: those run, broken or not.
  std::size_t done_in(std::string_view scenario) const;
  /// Prints a line for every measure: least, median, 99th percentile, most.
  void print_measures() const;

 private:
  const Options options_;
  std::mt19937_64 random_;
  std::string scenario_;
  std::size_t done_ = 0;
  std::size_t passed_ = 0;
  std::map<std::string, std::size_t, std::less<>> by_scenario_;
  std::map<std::string, Measure> measures_;
};

}  // namespace fairway::chaos
