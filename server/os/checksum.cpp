#include "server/os/checksum.h"

#include <openssl/evp.h>

namespace fairway {

void Checksum::Deleter::operator()(evp_md_ctx_st* context) const {
  EVP_MD_CTX_free(context);
}

Checksum::Checksum(ChecksumAlgorithm algorithm) : context_(EVP_MD_CTX_new()) {
  EVP_DigestInit_ex(context_.get(),
                    algorithm == ChecksumAlgorithm::sha1 ? EVP_sha1() : EVP_sha256(), nullptr);
}

void Checksum::update(std::span<const std::byte> bytes) {
  EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size());
}

std::vector<std::byte> Checksum::finish() {
  std::vector<std::byte> digest(EVP_MAX_MD_SIZE);
  unsigned size = 0;
  EVP_DigestFinal_ex(context_.get(), reinterpret_cast<unsigned char*>(digest.data()), &size);
  digest.resize(size);
  return digest;
}

}  // namespace fairway
