#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// What a client prefers (RFC 7240) of what this service can heed. All else is ignored, as are
/// preferences that do not parse; of one that is stated twice, the first counts.
struct Preferences {
  bool respond_async = false;
  std::optional<std::chrono::seconds> wait;  ///< at most a day
};

/// Reads all Prefer headers of a request.
Preferences preferences_of(const HttpRequest& request);

/// The value of Preference-Applied that names those in `applied`; "" if there are none.
std::string applied_text(const Preferences& applied);

}  // namespace fairway
