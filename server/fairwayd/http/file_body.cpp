#include "server/fairwayd/http/file_body.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <unistd.h>

namespace fairway {

std::uint64_t FileBody::size() const {
  std::uint64_t sum = 0;
  for (const FilePiece& piece : pieces) sum += piece.before.size() + piece.bytes;
  return sum;
}

FileBodyReader::FileBodyReader(FileBody body) : body_(std::move(body)) {}

std::size_t FileBodyReader::read(std::span<char> space) {
  while (piece_ < body_.pieces.size()) {
    const FilePiece& piece = body_.pieces[piece_];
    const std::uint64_t text = piece.before.size();
    if (at_ < text) {
      const std::size_t count = piece.before.copy(space.data(), space.size(), at_);
      at_ += count;
      return count;
    }
    if (at_ < text + piece.bytes) {
      const std::uint64_t from = at_ - text;
      const std::size_t count = std::min<std::uint64_t>(space.size(), piece.bytes - from);
      ssize_t got = 0;
      do {
        got =
            ::pread(body_.file.get(), space.data(), count, static_cast<off_t>(piece.offset + from));
      } while (got < 0 && errno == EINTR);
      if (got <= 0) return 0;
      at_ += static_cast<std::uint64_t>(got);
      return static_cast<std::size_t>(got);
    }
    ++piece_;
    at_ = 0;
  }
  return 0;
}

}  // namespace fairway
