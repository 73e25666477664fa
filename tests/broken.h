#pragma once

#include <chrono>
#include <stdexcept>
#include <string>

namespace fairway::test {

/// A trial or a case of a suite met what must not be.
class Broken : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Ends the trial or case with `found` where the promise does not hold.
inline void expect(bool holds, const std::string& found) {
  if (!holds) throw Broken(found);
}

/// Milliseconds from `began` until now.
inline double milliseconds_since(std::chrono::steady_clock::time_point began) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began)
      .count();
}

}  // namespace fairway::test
