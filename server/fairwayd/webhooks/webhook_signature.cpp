#include "server/fairwayd/webhooks/webhook_signature.h"

#include <fmt/format.h>

#include "server/fairwayd/store/webhook_secret.h"
#include "server/os/hmac.h"

namespace fairway {

std::string webhook_signature(std::span<const std::string> secrets, std::string_view id,
                              std::int64_t timestamp, std::string_view payload) {
  const std::string signed_text = fmt::format("{}.{}.{}", id, timestamp, payload);
  std::string signatures;
  for (const std::string& secret : secrets) {
    if (!secret.starts_with(kWebhookSecretPrefix)) continue;
    const auto hash =
        hmac_sha256(std::string_view(secret).substr(kWebhookSecretPrefix.size()), signed_text);
    if (!hash) continue;
    signatures += (signatures.empty() ? "v1," : " v1,") + *hash;
  }
  return signatures;
}

}  // namespace fairway
