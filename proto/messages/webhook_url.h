#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fairway {

inline constexpr std::size_t kMaxWebhookUrlBytes = 2048;

/// What every URL of a webhook matches, as a JSON Schema can say it: which numbers are ports it
/// leaves open.
inline constexpr std::string_view kWebhookUrlPattern =
    R"(^[Hh][Tt][Tt][Pp][Ss]?://([A-Za-z0-9._-]+|\[[0-9A-Fa-f:.]+\])(:[0-9]+)?)"
    R"(([/?][A-Za-z0-9._~:/?\[\]@!$&'()*+,;=%-]*)?$)";

/// What keeps a text from being the URL of a webhook, as the rest of a sentence about it that names
/// the remedy; empty where nothing does. A webhook's URL is absolute, of http or https (RFC 3986),
/// without user info and fragment.
std::string webhook_url_complaint(std::string_view url);

/// Scheme, host and port of such a URL, in lower case: "https://example.com:8443".
std::string origin_of_url(std::string_view url);

/// Such a URL as others may see it: what stands behind the question mark may be a secret.
/// "https://example.com/hook?…".
std::string shown_url(std::string_view url);

}  // namespace fairway
