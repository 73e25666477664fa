#pragma once

#include <cstdint>
#include <string>

#include "server/fairwayd/api/routes.h"
#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/uploads/resumable_uploads.h"

namespace fairway {

/// Resumable upload as tus 1.0.0 (https://tus.io/protocols/resumable-upload), with its extensions
/// creation, creation-with-upload, expiration, termination and checksum.
inline constexpr const char* kTusVersion = "1.0.0";

/// True for the places that speak it.
bool is_tus(Place place);

/// What OPTIONS tells there. `max_bytes`: of one upload.
NameValues tus_options(std::uint64_t max_bytes);

/// tus lets clients that cannot send PATCH or DELETE name them in X-HTTP-Method-Override of a POST.
HttpRequest with_tus_method(HttpRequest request);

/// Answers POST /v1/uploads and HEAD, PATCH, DELETE /v1/uploads/{id}. Errors: unsupported_format,
/// bad_request, those of ResumableUploads.
Result<HttpResponse> answer_tus(ResumableUploads& uploads, const Route& route,
                                const std::string& tenant, const HttpRequest& request,
                                BodySource& body);

}  // namespace fairway
