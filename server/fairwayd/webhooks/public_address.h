#pragma once

#include <array>
#include <cstdint>

struct sockaddr;

namespace fairway {

/// True for an address of the public internet that one host may have: none of the ranges that the
/// IANA special-purpose registries keep from being reached globally (loopback, private, shared,
/// link-local, unique local, documentation, benchmarking, reserved …), no multicast, and no IPv6
/// form (mapped, NAT64, 6to4, ISATAP) of such an IPv4 address. Bytes in network order.
bool is_public_ipv4(const std::array<std::uint8_t, 4>& address);
bool is_public_ipv6(const std::array<std::uint8_t, 16>& address);

/// The same of a socket's address; false for families other than IPv4 and IPv6.
bool is_public_address(const sockaddr& address);

}  // namespace fairway
