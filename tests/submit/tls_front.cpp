#include "tests/submit/tls_front.h"

#include <array>
#include <csignal>
#include <cstdio>
#include <vector>

#include <arpa/inet.h>
#include <catch2/catch.hpp>
#include <netinet/in.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <poll.h>
#include <sys/socket.h>

#include "tests/service/support/http_client.h"

namespace fairway::test {
namespace {

constexpr int kLookForStop = 50;  ///< milliseconds

template <auto Free>
struct Freed {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Context = std::unique_ptr<SSL_CTX, Freed<SSL_CTX_free>>;
using Session = std::unique_ptr<SSL, Freed<SSL_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;

/// Signed by itself, for an hour.
Certificate certificate_for(EVP_PKEY* key) {
  Certificate certificate(X509_new());
  X509_set_version(certificate.get(), X509_VERSION_3);
  ASN1_INTEGER_set(X509_get_serialNumber(certificate.get()), 1);
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -3600);
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), 3600);
  X509_set_pubkey(certificate.get(), key);
  X509_NAME* name = X509_get_subject_name(certificate.get());
  const auto* text = reinterpret_cast<const unsigned char*>("127.0.0.1");
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, text, -1, -1, 0);
  X509_set_issuer_name(certificate.get(), name);
  const Extension place(
      X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, "IP:127.0.0.1"));
  X509_add_ext(certificate.get(), place.get(), -1);
  REQUIRE(X509_sign(certificate.get(), key, EVP_sha256()) > 0);
  return certificate;
}

bool send_all(int socket, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t sent = ::send(socket, bytes, size, MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

}  // namespace

struct TlsFront::Secrets {
  Key key{EVP_RSA_gen(2048)};
  Certificate certificate = certificate_for(key.get());
  Context context{SSL_CTX_new(TLS_server_method())};
};

TlsFront::TlsFront(std::uint16_t server, const std::filesystem::path& certificate,
                   std::size_t cut_after)
    : secrets_(std::make_unique<Secrets>()),
      server_(server),
      cut_after_(cut_after),
      socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  std::signal(SIGPIPE, SIG_IGN);
  REQUIRE(SSL_CTX_use_certificate(secrets_->context.get(), secrets_->certificate.get()) == 1);
  REQUIRE(SSL_CTX_use_PrivateKey(secrets_->context.get(), secrets_->key.get()) == 1);
  std::FILE* file = std::fopen(certificate.c_str(), "w");
  REQUIRE(file != nullptr);
  PEM_write_X509(file, secrets_->certificate.get());
  std::fclose(file);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::bind(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  REQUIRE(::listen(socket_.get(), 16) == 0);
  socklen_t size = sizeof address;
  ::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
}

TlsFront::~TlsFront() = default;

void TlsFront::serve(const std::stop_token& stop) {
  std::vector<std::jthread> connections;
  while (!stop.stop_requested()) {
    pollfd entry{socket_.get(), POLLIN, 0};
    if (::poll(&entry, 1, kLookForStop) <= 0) continue;
    const int client = ::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC);
    connections.emplace_back([this, client, &stop] { carry(UniqueFd(client), stop); });
  }
}

/// Bytes go both ways until either side ends.
void TlsFront::carry(UniqueFd client, const std::stop_token& stop) const {
  const Session session(SSL_new(secrets_->context.get()));
  SSL_set_fd(session.get(), client.get());
  if (SSL_accept(session.get()) != 1) return;
  const UniqueFd server = connect_to(server_, std::chrono::seconds(60));
  std::array<char, 16384> chunk;
  for (std::size_t came = 0; !stop.stop_requested() && came < cut_after_;) {
    std::array<pollfd, 2> entries{{{client.get(), POLLIN, 0}, {server.get(), POLLIN, 0}}};
    if (SSL_pending(session.get()) == 0 && ::poll(entries.data(), 2, kLookForStop) <= 0) continue;
    if (SSL_pending(session.get()) > 0 || entries[0].revents != 0) {
      const int got = SSL_read(session.get(), chunk.data(), static_cast<int>(chunk.size()));
      if (got <= 0) return;
      came += static_cast<std::size_t>(got);
      if (!send_all(server.get(), chunk.data(), static_cast<std::size_t>(got))) return;
    }
    if (entries[1].revents != 0) {
      const ssize_t got = ::recv(server.get(), chunk.data(), chunk.size(), 0);
      if (got <= 0) return;
      if (SSL_write(session.get(), chunk.data(), static_cast<int>(got)) <= 0) return;
    }
  }
}

}  // namespace fairway::test
