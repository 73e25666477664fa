#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fairway::bench {

double median(std::vector<double> values);
double least(const std::vector<double>& values);

/// What a figure is held against.
struct Limit {
  enum class Kind { at_most, at_least };

  Kind kind = Kind::at_most;
  double value = 0.0;
};

/// Prints figures with their limits as they come, as a table or a JSON line each, and counts.
class Figures {
 public:
  explicit Figures(bool json);

  void line(const std::string& name, double value, const std::string& unit,
            std::optional<Limit> limit = {});
  /// A sentence below a figure.
  void note(const std::string& text) const;
  /// The last line: how many limits hold, and which do not.
  void summary() const;

 private:
  const bool json_;
  std::size_t limits_ = 0;
  std::vector<std::string> broken_;
};

}  // namespace fairway::bench
