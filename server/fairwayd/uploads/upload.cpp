#include "server/fairwayd/uploads/upload.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "server/fairwayd/uploads/file_spool.h"

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

Error query_error(UploadUse use) {
  return {ErrorCode::bad_request,
          use == UploadUse::job
              ? "The query takes params, with the URL-encoded parameter document, priority, ttl, "
                "deadline, webhook, and input or upload, each once, and label as often as needed."
              : "The query takes one key, params, with the URL-encoded parameter document."};
}

/// A number where it is one: what else it may be, the reader of the options tells.
Json number_or_text(const std::string& text) {
  std::int64_t number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, number);
  return status == std::errc() && stop == end ? Json(number) : Json(text);
}

Result<std::string> digest_of_input(const std::string& text) {
  constexpr std::string_view kAlgorithm = "sha256:";
  constexpr std::size_t kDigits = 64;
  const std::string digits = text.substr(std::min(kAlgorithm.size(), text.size()));
  const bool is_hex = std::all_of(digits.begin(), digits.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
  });
  if (text.starts_with(kAlgorithm) && digits.size() == kDigits && is_hex) return digits;
  return Error{ErrorCode::bad_request,
               "input is sha256: and the 64 lower-case hexadecimal digits of an earlier input."};
}

/// The texts of the parts that are no files. Each may come once.
struct PartTexts {
  std::optional<std::string> parameters = {};
  std::optional<std::string> options = {};
};

/// The parts of a multipart upload, in any order: `params`, `job`, and files.
class PartSorter {
 public:
  PartSorter(FileSpool& files, UploadUse use) : files_(files), use_(use) {}

  Result<void> begin(const PartHead& part) {
    if (++parts_ > kMaxUploadParts) {
      return Error{ErrorCode::bad_request,
                   fmt::format("A multipart upload has at most {} parts.", kMaxUploadParts)};
    }
    text_ = nullptr;
    if (part.name == "params") return begin_text(part, texts_.parameters);
    if (part.name == "job" && use_ == UploadUse::job) return begin_text(part, texts_.options);
    return files_.begin(part);
  }

  Result<void> append(std::span<const std::byte> bytes) {
    if (text_ == nullptr) return files_.append(bytes);
    if (bytes.size() > kMaxParameterBytes - text_->size()) {
      return Error{ErrorCode::too_large, "The parameter document is too long."};
    }
    text_->append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return {};
  }

  PartTexts take() { return std::move(texts_); }

 private:
  Result<void> begin_text(const PartHead& part, std::optional<std::string>& text) {
    if (text) {
      return Error{ErrorCode::bad_request,
                   fmt::format("A multipart upload has at most one part {}.", part.name)};
    }
    text_ = &text.emplace();
    return {};
  }

  FileSpool& files_;
  const UploadUse use_;
  std::size_t parts_ = 0;
  std::string* text_ = nullptr;  ///< of the part at hand, unless it is a file
  PartTexts texts_;
};

Result<PartTexts> read_multipart(BodySource& body, UploadUse use, FileSpool& files) {
  PartSorter sorter(files, use);
  auto read =
      body.read_parts([&](const PartHead& part) { return sorter.begin(part); },
                      [&](std::span<const std::byte> bytes) { return sorter.append(bytes); });
  if (!read) return read.error();
  return sorter.take();
}

/// A body that is one file.
Result<void> read_raw(const HttpRequest& request, BodySource& body, FileSpool& files) {
  if (auto begun = files.begin({"mesh", "", request.content_type}); !begun) return begun;
  return body.read([&](std::span<const std::byte> bytes) { return files.append(bytes); });
}

}  // namespace

Result<void> check_disk(BlobStore& blobs, std::uint64_t min_free, std::uint64_t needed) {
  const auto left = blobs.free_bytes();
  if (!left) return left.error();
  if (*left >= min_free && *left - min_free >= needed) return {};
  return Error{ErrorCode::storage_full,
               fmt::format("{} bytes are left, {} are to be.", *left, min_free)};
}

Result<UploadQuery> read_upload_query(const HttpRequest& request, UploadUse use) {
  UploadQuery query;
  Json options = Json::object();
  for (const auto& [name, value] : request.query) {
    const bool for_job = use == UploadUse::job;
    if (name == "params" && !query.parameters) {
      query.parameters = value;
    } else if (for_job && name == "label") {
      options["labels"].push_back(value);
    } else if (for_job && (name == "priority" || name == "ttl" || name == "deadline") &&
               !options.contains(name)) {
      options[name] = number_or_text(value);
    } else if (for_job && name == "webhook" && !options.contains(name)) {
      options[name] = Json{{"url", value}};
    } else if (for_job && name == "upload" && !query.names_input()) {
      query.upload = value;
    } else if (for_job && name == "input" && !query.names_input()) {
      auto digest = digest_of_input(value);
      if (!digest) return digest.error();
      query.input_sha256 = *std::move(digest);
    } else {
      return query_error(use);
    }
  }
  if (options.empty()) return query;
  auto read = read_job_options(options);
  if (!read) return read.error();
  query.options = *std::move(read);
  return query;
}

Result<void> check_upload(const HttpRequest& request, UploadUse use, std::uint64_t max_mesh_bytes) {
  const auto query = read_upload_query(request, use);
  if (!query) return query.error();
  if (request.has_content_encoding) {
    return Error{ErrorCode::unsupported_format,
                 "A content encoding is not taken: send the file's own bytes."};
  }
  if (!request.has_length && !query->names_input()) {
    return Error{ErrorCode::length_required, "Say with Content-Length how long the mesh is."};
  }
  const std::uint64_t limit = max_mesh_bytes + (is_multipart(request) ? kUploadOverhead : 0);
  if (request.content_length.value_or(0) > limit) return upload_too_large(max_mesh_bytes);
  if (auto parameters = parse_parameters(query->parameters.value_or("")); !parameters) {
    return parameters.error();
  }
  return {};
}

Result<Upload> receive_upload(const HttpRequest& request, UploadUse use, BodySource& body,
                              BlobStore& blobs, std::uint64_t max_mesh_bytes) {
  auto query = read_upload_query(request, use);
  if (!query) return query.error();
  Upload upload;
  PartTexts parts;
  if (!query->names_input()) {
    auto draft = blobs.create();
    if (!draft) return draft.error();
    FileSpool spool(**draft, max_mesh_bytes);
    if (is_multipart(request)) {
      auto read = read_multipart(body, use, spool);
      if (!read) return read.error();
      parts = *std::move(read);
    } else if (auto read = read_raw(request, body, spool); !read) {
      return read.error();
    }
    auto files = spool.finish();
    if (!files) return files.error();
    upload.mesh = std::move(*draft);
    upload.format = files->format;
    upload.files = files->count;
    upload.digest = std::move(files->digest);
  }
  if ((query->parameters && parts.parameters) || (query->options && parts.options)) {
    return Error{ErrorCode::bad_request,
                 "Send params and job in the query or as parts, not in both ways."};
  }
  const auto& text = query->parameters ? query->parameters : parts.parameters;
  auto parameters = parse_parameters(text.value_or(""));
  if (!parameters) return parameters.error();
  upload.parameters = std::move(*parameters);
  auto options = query->options ? Result<JobOptions>(*query->options)
                                : parse_job_options(parts.options.value_or(""));
  if (!options) return options.error();
  upload.options = *std::move(options);
  return upload;
}

}  // namespace fairway
