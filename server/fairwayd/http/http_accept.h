#pragma once

#include <string_view>

#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// Weight of what a client wants most.
inline constexpr int kFullWeight = 1000;

/// How much a client's Accept headers want `media_type` ("model/ply"), in thousandths; 0: they
/// exclude it. The most specific range that fits decides (RFC 9110, 12.5.1). Without an Accept, and
/// with one that names no range at all, everything has full weight. A range with parameters other
/// than q fits nothing, because our types have none; a weight that is no weight counts as full.
int accept_weight(const HttpRequest& request, std::string_view media_type);

/// True where the client's Accept-Encoding names `coding` ("gzip"), or "*", with a weight above 0
/// (RFC 9110, 12.5.3). Without one no coding is taken.
bool takes_coding(const HttpRequest& request, std::string_view coding);

}  // namespace fairway
