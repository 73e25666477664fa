#include "server/fairwayd/store/webhook_secret.h"

#include "server/os/hmac.h"

namespace fairway {

std::string new_webhook_secret() {
  constexpr std::size_t kBytes = 32;
  return std::string(kWebhookSecretPrefix) + random_base64(kBytes);
}

}  // namespace fairway
