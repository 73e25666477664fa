#include "server/os/sha256.h"

#include <array>
#include <cerrno>
#include <string_view>
#include <vector>

#include <openssl/evp.h>
#include <unistd.h>

#include "server/os/file.h"

namespace fairway {

void Sha256::Deleter::operator()(evp_md_ctx_st* context) const {
  EVP_MD_CTX_free(context);
}

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
}

void Sha256::update(std::span<const std::byte> bytes) {
  EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size());
}

std::string Sha256::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    text += kDigits[digest[i] >> 4U];
    text += kDigits[digest[i] & 15U];
  }
  return text;
}

Result<std::string> sha256_of_file(int fd) {
  Sha256 hash;
  std::vector<std::byte> chunk(std::size_t{1} << 18);
  off_t at = 0;
  for (;;) {
    const ssize_t got = ::pread(fd, chunk.data(), chunk.size(), at);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return file_error("read a file", errno);
    if (got == 0) return hash.hex();
    hash.update(std::span(chunk).first(static_cast<std::size_t>(got)));
    at += got;
  }
}

}  // namespace fairway
