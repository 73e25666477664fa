#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <stop_token>
#include <thread>

#include "server/os/unique_fd.h"

namespace fairway::test {

/// Ends TLS before a server on the loopback, with a certificate of its own for 127.0.0.1.
class TlsFront {
 public:
  /// Writes its certificate to the file. Every connection is cut when so many bytes have come from
  /// the client.
  TlsFront(std::uint16_t server, const std::filesystem::path& certificate,
           std::size_t cut_after = std::numeric_limits<std::size_t>::max());
  ~TlsFront();

  std::uint16_t port() const { return port_; }

 private:
  struct Secrets;

  void serve(const std::stop_token& stop);
  void carry(UniqueFd client, const std::stop_token& stop) const;

  std::unique_ptr<Secrets> secrets_;
  std::uint16_t server_;
  std::size_t cut_after_;
  UniqueFd socket_;
  std::uint16_t port_ = 0;
  std::jthread thread_;
};

}  // namespace fairway::test
