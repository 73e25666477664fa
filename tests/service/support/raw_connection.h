#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/os/unique_fd.h"

namespace fairway::test {

/// A connection to a server on the loopback, byte by byte.
class RawConnection {
 public:
  explicit RawConnection(std::uint16_t port);

  void send(std::string_view bytes);
  void close_sending();
  /// Reads until `mark` stands in received(), and returns all up to the mark's end; fails the test
  /// where the connection ends before, or nothing comes for a minute.
  std::string read_until(std::string_view mark);
  /// Reads to the end of the connection.
  std::string read_all();

 private:
  bool receive();

  UniqueFd socket_;
  std::string received_;  ///< not yet returned
};

}  // namespace fairway::test
