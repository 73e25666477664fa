#pragma once

#include "core/result.h"
#include "proto/messages/format.h"
#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/uploads/upload.h"

namespace fairway {

/// The result's format is excluded by the client's Accept.
Error not_acceptable(Format format);

/// Where the answer to a request is the result itself (POST /v1/denoise): lets Accept choose the
/// format if the parameters leave it open and it excludes the one that came. Draco is not chosen:
/// application/octet-stream is asked for by clients that mean any bytes. Errors: not_acceptable,
/// unless the client also takes a job document (Prefer).
Result<void> heed_accept(const HttpRequest& request, Upload& upload);

}  // namespace fairway
