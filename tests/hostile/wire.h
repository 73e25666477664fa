#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/os/unique_fd.h"
#include "tests/broken.h"
#include "tests/service/support/http_client.h"

namespace fairway::hostile {

using test::milliseconds_since;

/// One client's connection to the loopback; no call waits longer than it is told to.
class Wire {
 public:
  /// Throws Broken where no connection can be had. `from`: the client's own address.
  explicit Wire(std::uint16_t port, const char* from = "127.0.0.1");

  /// Sends until all is gone, the server has closed, or the time is over. Reads meanwhile what
  /// comes, so that an answer is seen although the request goes on. Returns the bytes sent.
  std::size_t send(std::string_view bytes, std::chrono::milliseconds time);
  /// What can be sent without waiting. Returns the bytes sent.
  std::size_t send_some(std::string_view bytes);
  void half_close();
  /// Reads until the server closes or the time is over.
  void read_until_closed(std::chrono::milliseconds time);
  /// Reads until one whole answer is there, the server closes, or the time is over.
  void read_answer(std::chrono::milliseconds time);

  bool is_closed() const { return closed_; }
  const std::string& received() const { return received_; }
  int descriptor() const { return socket_.get(); }

 private:
  bool receive();

  UniqueFd socket_;
  std::string received_;
  bool closed_ = false;
};

/// The answers in a stream of them, without those of 1xx. The last one may be cut short.
struct Answers {
  std::vector<test::Answer> whole;
  std::string heads;  ///< of all of them, as they came
  bool has_rest = false;
};
Answers answers_in(std::string_view received);

/// "POST PATH HTTP/1.1", Host, the lines and the empty line.
std::string head_of(std::string_view method, std::string_view path,
                    const std::vector<std::string>& lines = {});

}  // namespace fairway::hostile
