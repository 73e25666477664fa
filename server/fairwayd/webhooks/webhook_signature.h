#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace fairway {

/// The value of the header webhook-signature (Standard Webhooks 1.0): for each secret
/// "v1," and the base64 of HMAC-SHA-256 over "<id>.<timestamp>.<payload>", separated by spaces. A
/// text that is no secret signs nothing. `timestamp`: seconds since 1970, as in webhook-timestamp.
std::string webhook_signature(std::span<const std::string> secrets, std::string_view id,
                              std::int64_t timestamp, std::string_view payload);

}  // namespace fairway
