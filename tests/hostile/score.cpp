#include "tests/hostile/score.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <numeric>

#include <catch2/catch.hpp>
#include <fmt/format.h>

namespace fairway::hostile {
namespace {

constexpr std::size_t kLongestLine = 600;

/// On one line, without what a terminal would obey.
std::string shown(std::string_view text) {
  std::string line(text.substr(0, kLongestLine));
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return line;
}

}  // namespace

void Score::enter(std::string_view category) {
  const auto found = std::find_if(categories_.begin(), categories_.end(),
                                  [&](const Category& each) { return each.name == category; });
  current_ = static_cast<std::size_t>(found - categories_.begin());
  if (found == categories_.end()) categories_.push_back({std::string(category), 0, 0, {}});
}

bool Score::run(const std::string& name, const std::function<void()>& check) {
  ++current().done;
  std::string found;
  try {
    check();
    ++current().passed;
    return true;
  } catch (const Catch::TestFailureException&) {
    found = "see the line above";  // the reporter has printed what a helper required
  } catch (const std::exception& error) {
    found = shown(error.what());
  }
  tell(fmt::format("FAILED {} {}: {}", current().name, name, found));
  return false;
}

void Score::tell(std::string_view line) const {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void Score::note(const std::string& figures) {
  std::string& all = current().figures;
  all += (all.empty() ? "" : ", ") + figures;
}

std::size_t Score::done() const {
  return std::accumulate(categories_.begin(), categories_.end(), std::size_t{0},
                         [](std::size_t sum, const Category& each) { return sum + each.done; });
}

std::size_t Score::passed() const {
  return std::accumulate(categories_.begin(), categories_.end(), std::size_t{0},
                         [](std::size_t sum, const Category& each) { return sum + each.passed; });
}

void Score::print_table() const {
  fmt::print("\n{:<22} {:>6}  {:>6}\n", "category", "passed", "of");
  for (const Category& each : categories_) {
    fmt::print("{:<22} {:>6}  {:>6}  {}\n", each.name, each.passed, each.done, each.figures);
  }
}

}  // namespace fairway::hostile
