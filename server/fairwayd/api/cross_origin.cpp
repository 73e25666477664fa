#include "server/fairwayd/api/cross_origin.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

constexpr std::string_view kAny = "*";
constexpr const char* kRequestHeaders =
    "Authorization, Content-Type, Accept, Cache-Control, Idempotency-Key, If-Match, If-None-Match, "
    "If-Range, Last-Event-ID, Prefer, Range, traceparent, tracestate, Tus-Resumable, "
    "Upload-Checksum, Upload-Length, Upload-Metadata, Upload-Offset, X-HTTP-Method-Override";
constexpr const char* kAnswerHeaders =
    "Accept-Ranges, Content-Disposition, Content-Range, ETag, Location, Preference-Applied, "
    "RateLimit, RateLimit-Policy, Repr-Digest, Retry-After, Server-Timing, traceparent, "
    "Tus-Checksum-Algorithm, Tus-Extension, Tus-Max-Size, Tus-Resumable, Tus-Version, "
    "Upload-Expires, Upload-Length, Upload-Metadata, Upload-Offset";
/// Seconds that a browser may remember a preflight.
constexpr const char* kMaxAge = "7200";

bool is_safe(std::string_view method) {
  constexpr std::array<std::string_view, 3> kSafe = {"GET", "HEAD", "OPTIONS"};
  return std::find(kSafe.begin(), kSafe.end(), method) != kSafe.end();
}

/// "host:port" of "scheme://host:port".
std::string_view authority_of(std::string_view origin) {
  const std::size_t at = origin.find("://");
  return at == std::string_view::npos ? std::string_view() : origin.substr(at + 3);
}

bool is_origin(std::string_view text) {
  const std::string_view authority = authority_of(text);
  return (text.starts_with("http://") || text.starts_with("https://")) && !authority.empty() &&
         authority.find_first_of("/?#@ ,*") == std::string_view::npos;
}

}  // namespace

Result<std::vector<std::string>> parse_origins(std::string_view text) {
  std::vector<std::string> origins;
  for (const std::string_view each : split_field(text, ',')) {
    if (each != kAny && !is_origin(each)) {
      return Error{ErrorCode::usage,
                   fmt::format("takes origins such as https://app.example:8443 with commas "
                               "between them, or *, not \"{}\".",
                               each)};
    }
    origins.push_back(lower_case(each));
  }
  return origins;
}

bool CrossOrigin::allows(std::string_view origin) const {
  return std::any_of(origins_.begin(), origins_.end(), [&](const std::string& each) {
    return each == kAny || same_word(each, origin);
  });
}

Result<void> CrossOrigin::check(const HttpRequest& request) const {
  const auto origin = request.header("origin");
  if (!origin || is_safe(request.method) || allows(*origin)) return {};
  const std::string_view host = request.header("host").value_or("");
  if (!host.empty() && same_word(authority_of(*origin), host)) return {};
  return Error{ErrorCode::forbidden,
               "Pages of this origin may not send that here: allow it with --cors-origins."};
}

HttpResponse CrossOrigin::options(const HttpRequest& request, Place place) const {
  constexpr int kNoContent = 204;
  HttpResponse response;
  response.status = kNoContent;
  const std::string methods = allow_header(place);
  response.headers.emplace_back("Allow", methods);
  const auto origin = request.header("origin");
  if (origin && allows(*origin) && request.header("access-control-request-method")) {
    response.headers.emplace_back("Access-Control-Allow-Methods", methods);
    response.headers.emplace_back("Access-Control-Allow-Headers", kRequestHeaders);
    response.headers.emplace_back("Access-Control-Max-Age", kMaxAge);
  }
  return response;
}

void CrossOrigin::mark(const HttpRequest& request, HttpResponse& response) const {
  if (origins_.empty()) return;
  // The answer depends on who asks, also where nobody does.
  response.headers.emplace_back("Vary", "Origin");
  const auto origin = request.header("origin");
  if (!origin || !allows(*origin)) return;
  response.headers.emplace_back("Access-Control-Allow-Origin", *origin);
  response.headers.emplace_back("Access-Control-Expose-Headers", kAnswerHeaders);
}

}  // namespace fairway
