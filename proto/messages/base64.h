#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fairway {

/// Strict RFC 4648 base64: whole quanta, padding only at the end, unused bits zero, no white space.
/// Nothing where the text breaks one of these rules.
std::optional<std::vector<std::byte>> decode_base64(std::string_view text);

std::string encode_base64(std::span<const std::byte> bytes);

/// The payload of a "data:…;base64,…" URI; nothing for any other URI.
std::optional<std::string_view> data_uri_payload(std::string_view uri);

/// True for every "data:" URI (the scheme in any case).
bool is_data_uri(std::string_view uri);

/// "data:<media type>;base64,…".
std::string make_data_uri(std::span<const std::byte> bytes,
                          std::string_view media_type = "application/octet-stream");

}  // namespace fairway
