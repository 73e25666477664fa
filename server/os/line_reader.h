#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace fairway {

/// Cuts what arrives on a descriptor into lines of bounded length. Does not own the descriptor.
class LineReader {
 public:
  enum class Status {
    data,      ///< something arrived
    again,     ///< nothing now (non-blocking descriptor)
    end,       ///< the other side closed, or the connection broke
    too_long,  ///< a line is longer than allowed; the reader is of no more use
  };

  LineReader(int fd, std::size_t max_line) : fd_(fd), max_line_(max_line) {}

  /// One read(). Blocks exactly where the descriptor does.
  Status fill();

  /// The next whole line without its '\n', if there is one.
  std::optional<std::string> next();

 private:
  int fd_;
  std::size_t max_line_;
  std::string buffer_;
  std::size_t searched_ = 0;  ///< buffer_ holds no '\n' before this place
};

}  // namespace fairway
