#pragma once

#include <string>
#include <string_view>

namespace fairway {

/// What stands before the base64 of a secret (Standard Webhooks 1.0).
inline constexpr std::string_view kWebhookSecretPrefix = "whsec_";

/// A secret as Standard Webhooks writes it: the prefix and 32 random bytes in base64.
std::string new_webhook_secret();

}  // namespace fairway
