#pragma once

#include <string_view>

#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// Answers a GET or HEAD of a page or of what it loads: with the file, compressed where the client
/// takes gzip, or 304 where it has it. Pages may load what this service has and nothing else, and
/// run no code that stands in them. not_found for what there is not.
HttpResponse site_answer(const HttpRequest& request);

}  // namespace fairway
