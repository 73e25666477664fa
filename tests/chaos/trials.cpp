#include "tests/chaos/trials.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/chaos/watchdog.h"

namespace fairway::chaos {
namespace {

constexpr std::chrono::seconds kLongestTrial{60};
constexpr std::size_t kLongestLine = 500;

double at(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted.at(std::max<std::size_t>(rank, 1) - 1);
}

}  // namespace

void Trials::enter(std::string_view scenario) {
  scenario_ = scenario;
}

bool Trials::run(const std::string& name, const std::function<void()>& trial) {
  ++done_;
  ++by_scenario_[scenario_];
  if (was_interrupted()) return false;
  const Watchdog watchdog(kLongestTrial);
  try {
    trial();
    ++passed_;
    return true;
  } catch (const Broken& broken) {
    fmt::print("BROKEN {} {}: {}\n", scenario_, name,
               std::string_view(broken.what()).substr(0, kLongestLine));
  } catch (const Catch::TestFailureException&) {
    // The reporter has printed what the helper required.
    fmt::print("BROKEN {} {}: see the line above\n", scenario_, name);
  } catch (const std::exception& error) {
    fmt::print("BROKEN {} {}: {}\n", scenario_, name, error.what());
  }
  std::fflush(stdout);
  return false;
}

std::size_t Trials::scaled(std::size_t full) const {
  const auto wanted = std::ceil(static_cast<double>(full) * options_.scale);
  return std::max<std::size_t>(1, static_cast<std::size_t>(wanted));
}

std::size_t Trials::random(std::size_t low, std::size_t high) {
  return std::uniform_int_distribution<std::size_t>(low, high)(random_);
}

void Trials::measure(const std::string& name, const std::vector<double>& values,
                     const std::string& unit, double bound) {
  if (values.empty()) return;
  Measure& measure = measures_[name];
  measure.values.insert(measure.values.end(), values.begin(), values.end());
  measure.unit = unit;
  measure.bound = bound * options_.patience;
  const double most = *std::max_element(values.begin(), values.end());
  expect(bound == 0.0 || most <= measure.bound,
         fmt::format("{}: {:.1f} {}, at most {} are promised", name, most, unit, measure.bound));
}

void Trials::measure(const std::string& name, double value, const std::string& unit, double bound) {
  measure(name, std::vector{value}, unit, bound);
}

void Trials::note(const std::string& name, double value) {
  measures_[name].values.push_back(value);
}

std::size_t Trials::done_in(std::string_view scenario) const {
  const auto found = by_scenario_.find(scenario);
  return found == by_scenario_.end() ? 0 : found->second;
}

void Trials::print_measures() const {
  for (const auto& [name, measure] : measures_) {
    std::vector<double> sorted = measure.values;
    std::sort(sorted.begin(), sorted.end());
    if (sorted.size() == 1) {
      fmt::print("{:<46} {:.1f} {}", name, sorted.front(), measure.unit);
    } else {
      fmt::print("{:<46} least {:.1f}, median {:.1f}, p99 {:.1f}, most {:.1f} {} ({} values)", name,
                 sorted.front(), at(sorted, 0.5), at(sorted, 0.99), sorted.back(), measure.unit,
                 sorted.size());
    }
    if (measure.bound > 0.0) fmt::print(", promised {}", measure.bound);
    fmt::print("\n");
  }
}

}  // namespace fairway::chaos
