#pragma once

#include <cstddef>
#include <string>

namespace fairway::chaos {

/// A mesh with what is asked for, and what an undisturbed run makes of it.
struct Work {
  std::string mesh;
  std::string parameters;
  std::string sha256;  ///< of the result of `fairway denoise`, without any service
  double milliseconds = 0.0;
};

/// Makes work that no other one equals, so that no result can stand in for another.
class Workshop {
 public:
  Workshop();

  /// Done in a few milliseconds.
  Work small();
  /// The same, with a report of several pages of the database.
  Work verbose();
  /// Takes long enough to be disturbed at any moment: some hundred milliseconds.
  Work busy();
  /// Runs until it is canceled.
  Work endless() const;

 private:
  Work work(const std::string& mesh, const char* parameters);

  const std::string small_mesh_;
  const std::string busy_mesh_;
  std::size_t count_ = 0;
};

/// 64 lower-case hexadecimal digits.
std::string sha256_of(const std::string& bytes);

}  // namespace fairway::chaos
