#include "server/fairwayd/site/site.h"

#include <algorithm>
#include <string>

#include "server/fairwayd/http/http_accept.h"
#include "server/fairwayd/http/http_conditions.h"
#include "server/fairwayd/site/site_file.h"

namespace fairway {
namespace {

/// Of the page with the viewer: wasm and blobs are how decoders and textures get into a browser.
constexpr const char* kPagePolicy =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; "
    "img-src 'self' blob: data:; connect-src 'self' blob: data:; worker-src 'self' blob:; "
    "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Of the documentation, which saves answers through blob: links; they need no permission.
constexpr const char* kDocsPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const SiteFile* find_file(std::string_view path) {
  const auto files = site_files();
  const auto at = std::lower_bound(
      files.begin(), files.end(), path,
      [](const SiteFile& file, std::string_view wanted) { return file.path < wanted; });
  return at != files.end() && at->path == path ? &*at : nullptr;
}

/// Files below /assets/ have their digest in their names.
const char* cache_policy(std::string_view path) {
  return path.starts_with("/assets/") ? "public, max-age=31536000, immutable" : "no-cache";
}

void add_page_headers(HttpResponse& response, std::string_view path) {
  response.headers.emplace_back("Content-Security-Policy", path == "/" ? kPagePolicy : kDocsPolicy);
  response.headers.emplace_back("Referrer-Policy", "no-referrer");
  response.headers.emplace_back("Cross-Origin-Opener-Policy", "same-origin");
}

}  // namespace

HttpResponse site_answer(const HttpRequest& request) {
  const SiteFile* const file = find_file(request.path);
  if (file == nullptr) {
    return problem_response({ErrorCode::not_found, "There is nothing at this path."});
  }
  const bool packed = !file->gzip.empty() && takes_coding(request, "gzip");
  const EntityTag tag{std::string(file->tag) + (packed ? "-gzip" : "")};
  HttpResponse response;
  response.headers.emplace_back("ETag", to_string(tag));
  response.headers.emplace_back("Cache-Control", cache_policy(file->path));
  response.headers.emplace_back("Vary", "Accept-Encoding");
  if (evaluate_conditions(request, tag) == Condition::not_modified) {
    response.status = 304;
    return response;
  }
  response.content_type = file->media_type;
  response.body = packed ? file->gzip : file->bytes;
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  if (packed) response.headers.emplace_back("Content-Encoding", "gzip");
  if (file->media_type.starts_with("text/html")) add_page_headers(response, file->path);
  return response;
}

}  // namespace fairway
