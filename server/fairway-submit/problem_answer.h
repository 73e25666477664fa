#pragma once

#include "proto/messages/json.h"
#include "server/fairway-submit/http_session.h"

namespace fairway {

/// The problem that an answer states; one about the answer itself where it states none. Has title,
/// detail and code.
Json problem_of(const HttpAnswer& answer);

}  // namespace fairway
