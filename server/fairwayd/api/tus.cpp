#include "server/fairwayd/api/tus.h"

#include <fmt/format.h>

#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

constexpr std::string_view kBytesType = "application/offset+octet-stream";

bool has_body(const HttpRequest& request) {
  return request.has_length && request.content_length.value_or(1) > 0;
}

/// Whether its body is bytes of an upload.
Result<void> check_type(const HttpRequest& request) {
  const std::string_view type = request.content_type;
  if (same_word(trim_blanks(type.substr(0, type.find(';'))), kBytesType) &&
      !request.has_content_encoding) {
    return {};
  }
  return Error{ErrorCode::unsupported_format,
               fmt::format("Send the file's own bytes as {}.", kBytesType)};
}

/// The number in a header; `name` as the protocol writes it. Errors: bad_request.
Result<std::uint64_t> number_in(const HttpRequest& request, std::string_view name) {
  const auto text = request.header(lower_case(name));
  const auto number = text ? digits_value(*text) : std::nullopt;
  if (number) return *number;
  return Error{ErrorCode::bad_request,
               fmt::format("{} is needed, a number of bytes; it cannot be deferred.", name)};
}

Result<UploadChunk> chunk_of(const HttpRequest& request, std::uint64_t offset) {
  UploadChunk chunk{offset, request.content_length, {}};
  if (const auto text = request.header("upload-checksum")) {
    auto checksum = parse_upload_checksum(*text);
    if (!checksum) return checksum.error();
    chunk.checksum = *std::move(checksum);
  }
  return chunk;
}

HttpResponse told(int status, const ResumableUpload& upload) {
  HttpResponse response;
  response.status = status;
  response.headers.emplace_back("Upload-Expires", http_date(upload.expires));
  response.headers.emplace_back("Cache-Control", "no-store");
  return response;
}

HttpResponse told(int status, const UploadState& state) {
  HttpResponse response = told(status, state.upload);
  response.headers.emplace_back("Upload-Offset", fmt::to_string(state.offset));
  return response;
}

Result<HttpResponse> create(ResumableUploads& uploads, const std::string& tenant,
                            const HttpRequest& request, BodySource& body) {
  constexpr int kCreated = 201;
  const auto length = number_in(request, "Upload-Length");
  if (!length) return length.error();
  const auto chunk = chunk_of(request, 0);
  if (!chunk) return chunk.error();
  if (has_body(request)) {
    if (auto typed = check_type(request); !typed) return typed.error();
  }
  const std::string metadata(request.header("upload-metadata").value_or(""));
  const auto upload = uploads.create(tenant, *length, metadata);
  if (!upload) return upload.error();
  HttpResponse response = told(kCreated, *upload);
  if (has_body(request)) {
    const auto state = uploads.append(upload->name, *chunk, body);
    if (!state) {
      // Nobody would learn its address.
      if (auto removed = uploads.remove(upload->name); !removed) return removed.error();
      return state.error();
    }
    response = told(kCreated, *state);
  }
  response.headers.emplace_back("Location", "/v1/uploads/" + upload->name.id);
  return response;
}

Result<HttpResponse> show(ResumableUploads& uploads, const UploadName& name) {
  const auto state = uploads.state(name);
  if (!state) return state.error();
  HttpResponse response = told(200, *state);
  response.headers.emplace_back("Upload-Length", fmt::to_string(state->upload.length));
  if (!state->upload.metadata.empty()) {
    response.headers.emplace_back("Upload-Metadata", state->upload.metadata);
  }
  return response;
}

Result<HttpResponse> patch(ResumableUploads& uploads, const UploadName& name,
                           const HttpRequest& request, BodySource& body) {
  constexpr int kNoContent = 204;
  if (auto typed = check_type(request); !typed) return typed.error();
  const auto offset = number_in(request, "Upload-Offset");
  if (!offset) return offset.error();
  const auto chunk = chunk_of(request, *offset);
  if (!chunk) return chunk.error();
  const auto state = uploads.append(name, *chunk, body);
  if (!state) return state.error();
  return told(kNoContent, *state);
}

Result<HttpResponse> remove(ResumableUploads& uploads, const UploadName& name) {
  constexpr int kNoContent = 204;
  if (auto removed = uploads.remove(name); !removed) return removed.error();
  HttpResponse response;
  response.status = kNoContent;
  return response;
}

}  // namespace

bool is_tus(Place place) {
  return place == Place::uploads || place == Place::upload;
}

NameValues tus_options(std::uint64_t max_bytes) {
  return {{"Tus-Version", kTusVersion},
          {"Tus-Extension", "creation,creation-with-upload,expiration,termination,checksum"},
          {"Tus-Max-Size", fmt::to_string(max_bytes)},
          {"Tus-Checksum-Algorithm", std::string(kChecksumAlgorithms)}};
}

HttpRequest with_tus_method(HttpRequest request) {
  const auto route = route_of(request.path);
  const auto method = request.header("x-http-method-override");
  if (route && is_tus(route->place) && request.method == "POST" && method &&
      (*method == "PATCH" || *method == "DELETE")) {
    request.method = *method;
  }
  return request;
}

Result<HttpResponse> answer_tus(ResumableUploads& uploads, const Route& route,
                                const std::string& tenant, const HttpRequest& request,
                                BodySource& body) {
  if (request.header("tus-resumable").value_or("") != kTusVersion) {
    HttpResponse response = problem_response(
        {ErrorCode::precondition_failed,
         fmt::format("Uploads speak tus {0}: send the header Tus-Resumable: {0}.", kTusVersion)});
    response.headers.emplace_back("Tus-Version", kTusVersion);
    return response;
  }
  const UploadName name{tenant, route.id};
  if (request.method == "POST") return create(uploads, tenant, request, body);
  if (request.method == "HEAD") return show(uploads, name);
  if (request.method == "PATCH") return patch(uploads, name, request, body);
  return remove(uploads, name);
}

}  // namespace fairway
