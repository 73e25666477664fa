#include "server/os/line_reader.h"

#include <array>
#include <cerrno>

#include <unistd.h>

namespace fairway {

LineReader::Status LineReader::fill() {
  std::array<char, 16384> chunk;
  ssize_t got = 0;
  do {
    got = ::read(fd_, chunk.data(), chunk.size());
  } while (got < 0 && errno == EINTR);
  if (got < 0) return errno == EAGAIN ? Status::again : Status::end;
  if (got == 0) return Status::end;
  buffer_.append(chunk.data(), static_cast<std::size_t>(got));
  searched_ = buffer_.find('\n', searched_);
  if (searched_ == std::string::npos) searched_ = buffer_.size();
  return searched_ > max_line_ ? Status::too_long : Status::data;
}

std::optional<std::string> LineReader::next() {
  const std::size_t end = buffer_.find('\n', searched_);
  if (end == std::string::npos) {
    searched_ = buffer_.size();
    return std::nullopt;
  }
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  searched_ = 0;
  return line;
}

}  // namespace fairway
