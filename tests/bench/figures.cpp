#include "tests/bench/figures.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace fairway::bench {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2.0;
}

double least(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::min_element(values.begin(), values.end());
}

Figures::Figures(bool json) : json_(json) {
  if (!json_) {
    fmt::print("{:<46}{:>10} {:<8}{:>10}  {}\n", "figure", "value", "", "limit", "holds");
  }
}

void Figures::line(const std::string& name, double value, const std::string& unit,
                   std::optional<Limit> limit) {
  const bool upper = limit && limit->kind == Limit::Kind::at_most;
  const bool holds = !limit || (upper ? value <= limit->value : value >= limit->value);
  if (limit) ++limits_;
  if (!holds) broken_.push_back(name);
  if (json_) {
    fmt::print(R"({{"name":"{}","value":{:.3f},"unit":"{}","limit":{},"holds":{}}})"
               "\n",
               name, value, unit, limit ? fmt::format("{:.3f}", limit->value) : "null",
               limit ? fmt::to_string(holds) : "null");
  } else {
    const std::string bound =
        limit ? fmt::format("{} {:.2f}", upper ? "<=" : ">=", limit->value) : "-";
    fmt::print("{:<46}{:>10.2f} {:<8}{:>10}  {}\n", name, value, unit, bound,
               !limit  ? ""
               : holds ? "yes"
                       : "NO");
  }
  std::fflush(stdout);
}

void Figures::note(const std::string& text) const {
  if (!json_) fmt::print("  {}\n", text);
  std::fflush(stdout);
}

void Figures::summary() const {
  if (json_) return;
  const std::size_t held = limits_ - broken_.size();
  fmt::print("{} of {} limits hold{}{}\n", held, limits_,
             broken_.empty() ? "" : "; not: ", fmt::join(broken_, ", "));
}

}  // namespace fairway::bench
