// RFC 6890 and the IANA registries of special-purpose addresses, as of 2024.

#include "server/fairwayd/webhooks/public_address.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include <netinet/in.h>
#include <sys/socket.h>

namespace fairway {
namespace {

using V4 = std::array<std::uint8_t, 4>;
using V6 = std::array<std::uint8_t, 16>;

/// All addresses whose first `bits` are those of `address`.
template <class Address>
struct Block {
  Address address;
  unsigned bits;

  constexpr bool contains(const Address& other) const {
    for (unsigned bit = 0; bit < bits; ++bit) {
      const unsigned mask = 0x80U >> (bit % 8);
      if ((address.at(bit / 8) & mask) != (other.at(bit / 8) & mask)) return false;
    }
    return true;
  }
};

constexpr std::array kNotPublicV4 = {
    Block<V4>{{0}, 8},             // this network
    Block<V4>{{10}, 8},            // private
    Block<V4>{{100, 64}, 10},      // shared by carriers
    Block<V4>{{127}, 8},           // loopback
    Block<V4>{{169, 254}, 16},     // link-local
    Block<V4>{{172, 16}, 12},      // private
    Block<V4>{{192, 0, 0}, 24},    // protocol assignments
    Block<V4>{{192, 0, 2}, 24},    // documentation
    Block<V4>{{192, 88, 99}, 24},  // 6to4 relays, given up
    Block<V4>{{192, 168}, 16},     // private
    Block<V4>{{198, 18}, 15},      // benchmarking
    Block<V4>{{198, 51, 100}, 24},
    Block<V4>{{203, 0, 113}, 24},  // documentation
    Block<V4>{{224}, 4},           // multicast
    Block<V4>{{240}, 4},           // reserved, broadcast
};

// Global unicast, of which a few blocks are not; nothing else is public but NAT64.
constexpr Block<V6> kGlobalUnicast{{0x20}, 3};
constexpr std::array kNotPublicV6 = {
    Block<V6>{{0x20, 0x01}, 23},              // protocol assignments, Teredo, ORCHID
    Block<V6>{{0x20, 0x01, 0x0d, 0xb8}, 32},  // documentation
    Block<V6>{{0x3f, 0xff}, 20},              // documentation
};

// Addresses that stand for an IPv4 address, and where it stands in them.
constexpr Block<V6> kMapped{{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff}, 96};
constexpr Block<V6> kNat64{{0, 0x64, 0xff, 0x9b}, 96};
constexpr Block<V6> kSixToFour{{0x20, 0x02}, 16};

V4 inner(const V6& address, std::size_t at) {
  return {address.at(at), address.at(at + 1), address.at(at + 2), address.at(at + 3)};
}

/// Any prefix, then 00-00-5E-FE or 02-00-5E-FE (RFC 5214).
bool is_isatap(const V6& address) {
  return (address[8] & ~0x02U) == 0 && address[9] == 0 && address[10] == 0x5e &&
         address[11] == 0xfe;
}

template <class Blocks, class Address>
bool is_in(const Blocks& blocks, const Address& address) {
  return std::any_of(blocks.begin(), blocks.end(),
                     [&](const auto& block) { return block.contains(address); });
}

}  // namespace

bool is_public_ipv4(const V4& address) {
  return !is_in(kNotPublicV4, address);
}

bool is_public_ipv6(const V6& address) {
  if (kMapped.contains(address) || kNat64.contains(address)) {
    return is_public_ipv4(inner(address, 12));
  }
  if (!kGlobalUnicast.contains(address) || is_in(kNotPublicV6, address)) return false;
  if (kSixToFour.contains(address)) return is_public_ipv4(inner(address, 2));
  return !is_isatap(address) || is_public_ipv4(inner(address, 12));
}

bool is_public_address(const sockaddr& address) {
  if (address.sa_family == AF_INET) {
    V4 bytes{};
    std::memcpy(bytes.data(), &reinterpret_cast<const sockaddr_in&>(address).sin_addr, 4);
    return is_public_ipv4(bytes);
  }
  if (address.sa_family == AF_INET6) {
    V6 bytes{};
    std::memcpy(bytes.data(), &reinterpret_cast<const sockaddr_in6&>(address).sin6_addr, 16);
    return is_public_ipv6(bytes);
  }
  return false;
}

}  // namespace fairway
