#include "server/fairwayd/upload.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/file_spool.h"

namespace fairway {
namespace {

constexpr std::string_view kMultipart = "multipart/form-data";

bool is_multipart(const HttpRequest& request) {
  const std::string_view type = request.content_type;
  return type.size() >= kMultipart.size() &&
         std::equal(kMultipart.begin(), kMultipart.end(), type.begin(), [](char a, char b) {
           return a == std::tolower(static_cast<unsigned char>(b));
         });
}

/// The value of `params` in the query. Nothing else may stand there.
Result<std::optional<std::string>> query_parameters(const HttpRequest& request) {
  std::optional<std::string> found;
  for (const auto& [name, value] : request.query) {
    if (name != "params" || found) {
      return Error{ErrorCode::bad_request,
                   "The query takes one key, params, with the URL-encoded parameter document."};
    }
    found = value;
  }
  return found;
}

/// The parts of a multipart upload, in any order: `params`, and files.
class PartSorter {
 public:
  explicit PartSorter(FileSpool& files) : files_(files) {}

  Result<void> begin(const PartHead& part) {
    if (++parts_ > kMaxUploadParts) {
      return Error{ErrorCode::bad_request,
                   fmt::format("A multipart upload has at most {} parts.", kMaxUploadParts)};
    }
    in_parameters_ = part.name == "params";
    if (!in_parameters_) return files_.begin(part);
    if (parameters_) {
      return Error{ErrorCode::bad_request, "A multipart upload has at most one part params."};
    }
    parameters_.emplace();
    return {};
  }

  Result<void> append(std::span<const std::byte> bytes) {
    if (!in_parameters_) return files_.append(bytes);
    if (bytes.size() > kMaxParameterBytes - parameters_->size()) {
      return Error{ErrorCode::too_large, "The parameter document is too long."};
    }
    parameters_->append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return {};
  }

  const std::optional<std::string>& parameters() const { return parameters_; }

 private:
  FileSpool& files_;
  std::size_t parts_ = 0;
  bool in_parameters_ = false;
  std::optional<std::string> parameters_;
};

/// Returns the text of the part `params`, if there is one.
Result<std::optional<std::string>> read_multipart(BodySource& body, FileSpool& files) {
  PartSorter sorter(files);
  auto read =
      body.read_parts([&](const PartHead& part) { return sorter.begin(part); },
                      [&](std::span<const std::byte> bytes) { return sorter.append(bytes); });
  if (!read) return read.error();
  return sorter.parameters();
}

/// A body that is one file.
Result<void> read_raw(const HttpRequest& request, BodySource& body, FileSpool& files) {
  if (auto begun = files.begin({"mesh", "", request.content_type}); !begun) return begun;
  return body.read([&](std::span<const std::byte> bytes) { return files.append(bytes); });
}

}  // namespace

Result<void> check_upload(const HttpRequest& request, std::uint64_t max_mesh_bytes) {
  if (request.has_content_encoding) {
    return Error{ErrorCode::unsupported_format,
                 "A content encoding is not taken: send the file's own bytes."};
  }
  if (!request.has_length) {
    return Error{ErrorCode::length_required, "Say with Content-Length how long the mesh is."};
  }
  const std::uint64_t limit = max_mesh_bytes + (is_multipart(request) ? kUploadOverhead : 0);
  if (request.content_length.value_or(0) > limit) return upload_too_large(max_mesh_bytes);
  const auto text = query_parameters(request);
  if (!text) return text.error();
  if (auto parameters = parse_parameters(text->value_or("")); !parameters) {
    return parameters.error();
  }
  return {};
}

Result<Upload> receive_upload(const HttpRequest& request, BodySource& body, BlobStore& blobs,
                              std::uint64_t max_mesh_bytes) {
  auto text = query_parameters(request);
  if (!text) return text.error();
  auto draft = blobs.create();
  if (!draft) return draft.error();
  FileSpool spool(**draft, max_mesh_bytes);
  if (is_multipart(request)) {
    auto part = read_multipart(body, spool);
    if (!part) return part.error();
    if (*text && *part) {
      return Error{ErrorCode::bad_request, "Send params in the query or as a part, not both."};
    }
    if (*part) *text = std::move(*part);
  } else if (auto read = read_raw(request, body, spool); !read) {
    return read.error();
  }
  auto files = spool.finish();
  if (!files) return files.error();
  auto parameters = parse_parameters(text->value_or(""));
  if (!parameters) return parameters.error();
  return Upload{std::move(*draft), files->format, files->count, std::move(*parameters)};
}

}  // namespace fairway
