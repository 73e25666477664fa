#include "server/os/descriptor_passing.h"

#include <array>
#include <cerrno>
#include <cstring>

#include <sys/socket.h>

#include "server/os/file.h"

namespace fairway {
namespace {

/// Room for the descriptors beside a message, aligned as the system wants it.
struct Control {
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kMostPassed * sizeof(int))> bytes = {};
};

}  // namespace

Result<void> send_with_descriptors(int socket, std::span<const char> bytes,
                                   std::span<const int> descriptors) {
  Control control;
  iovec piece = {const_cast<char*>(bytes.data()), bytes.size()};
  msghdr message = {};
  message.msg_iov = &piece;
  message.msg_iovlen = 1;
  if (!descriptors.empty()) {
    message.msg_control = control.bytes.data();
    message.msg_controllen = CMSG_SPACE(descriptors.size_bytes());
    cmsghdr* head = CMSG_FIRSTHDR(&message);
    head->cmsg_level = SOL_SOCKET;
    head->cmsg_type = SCM_RIGHTS;
    head->cmsg_len = CMSG_LEN(descriptors.size_bytes());
    std::memcpy(CMSG_DATA(head), descriptors.data(), descriptors.size_bytes());
  }
  while (piece.iov_len > 0) {
    const ssize_t sent = ::sendmsg(socket, &message, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return Error{ErrorCode::io, system_sentence("send a message", errno)};
    piece.iov_base = static_cast<char*>(piece.iov_base) + sent;
    piece.iov_len -= static_cast<std::size_t>(sent);
    message.msg_control = nullptr;
    message.msg_controllen = 0;
  }
  return {};
}

Result<Passed> receive_with_descriptors(int socket) {
  Control control;
  std::array<char, 16384> chunk;
  iovec piece = {chunk.data(), chunk.size()};
  msghdr message = {};
  message.msg_iov = &piece;
  message.msg_iovlen = 1;
  message.msg_control = control.bytes.data();
  message.msg_controllen = control.bytes.size();
  ssize_t got = 0;
  do {
    got = ::recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
  } while (got < 0 && errno == EINTR);
  if (got < 0) return Error{ErrorCode::io, system_sentence("receive a message", errno)};
  Passed passed{{chunk.data(), static_cast<std::size_t>(got)}, {}};
  for (cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr;
       head = CMSG_NXTHDR(&message, head)) {
    if (head->cmsg_level != SOL_SOCKET || head->cmsg_type != SCM_RIGHTS) continue;
    for (std::size_t at = CMSG_LEN(0); at + sizeof(int) <= head->cmsg_len; at += sizeof(int)) {
      int fd = -1;
      std::memcpy(&fd, reinterpret_cast<const char*>(head) + at, sizeof fd);
      passed.descriptors.emplace_back(fd);
    }
  }
  return passed;
}

}  // namespace fairway
