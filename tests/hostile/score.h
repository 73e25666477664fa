#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/broken.h"

namespace fairway::hostile {

using test::Broken;
using test::expect;
using test::milliseconds_since;

/// Counts the cases of each category, and says at once which of them failed.
class Score {
 public:
  /// The category that the next cases belong to.
  void enter(std::string_view category);
  /// Runs one case. False where it failed.
  bool run(const std::string& name, const std::function<void()>& check);
  /// A line for the reader; no case.
  void tell(std::string_view line) const;
  /// A column beside the category's counts: its most telling figures.
  void note(const std::string& figures);

  std::size_t done() const;
  std::size_t passed() const;
  void print_table() const;

 private:
  struct Category {
    std::string name;
    std::size_t passed = 0;
    std::size_t done = 0;
    std::string figures;
  };

  Category& current() { return categories_.at(current_); }

  std::vector<Category> categories_;
  std::size_t current_ = 0;
};

}  // namespace fairway::hostile
