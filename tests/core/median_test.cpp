// Medians against sorting.

#include "core/median.h"

#include <algorithm>
#include <vector>

#include <catch2/catch.hpp>

#include "tests/core/generated_meshes.h"

namespace fairway::test {
namespace {

/// By sorting what is not negative.
template <class Real>
MedianAndLargest<Real> expected(std::vector<Real> values) {
  std::erase_if(values, [](Real v) { return v < 0; });
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  const Real upper = values[middle];
  return {values.size() % 2 == 1 ? upper : (values[middle - 1] + upper) / 2, values.back()};
}

template <class Real>
void check(const std::vector<Real>& values) {
  std::vector<Real> scratch = values;
  const MedianAndLargest<Real> found = median_and_largest(scratch);
  const MedianAndLargest<Real> wanted = expected(values);
  CHECK(found.median == wanted.median);
  CHECK(found.largest == wanted.largest);
}

}  // namespace

TEMPLATE_TEST_CASE("the median and the largest are those of sorting, whatever is negative", "",
                   float, double) {
  check<TestType>({});
  check<TestType>({-1, -2});
  check<TestType>({0});
  check<TestType>({0, 0, 0, 0});
  check<TestType>({1, 1000});      // the middle two lie far apart
  check<TestType>({-1, 1, 3, 3});  // the largest twice
  Random random(3);
  for (std::size_t size = 1; size < 300; ++size) {
    std::vector<TestType> values;
    for (std::size_t i = 0; i < size; ++i) {
      const double spread = random.chance(0.5) ? 1.0 : 1e6;
      values.push_back(static_cast<TestType>(random.uniform(-0.2, 1.0) * spread));
    }
    check(values);
  }
}

}  // namespace fairway::test
