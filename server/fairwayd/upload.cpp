#include "server/fairwayd/upload.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::string_view kMultipart = "multipart/form-data";

Error too_large(std::uint64_t limit) {
  return {ErrorCode::too_large,
          fmt::format("The mesh is larger than the {} bytes this server takes.", limit)};
}

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

/// The mesh on its way into the spool: counted, and recognised by its first bytes.
class MeshSink {
 public:
  MeshSink(BlobDraft& draft, std::uint64_t limit) : draft_(draft), limit_(limit) {}

  void declare(std::string type, std::string file_name) {
    declared_type_ = std::move(type);
    file_name_ = std::move(file_name);
  }

  Result<void> append(std::span<const std::byte> bytes) {
    if (bytes.size() > limit_ - count_) return too_large(limit_);
    count_ += bytes.size();
    const std::size_t wanted = std::min(bytes.size(), kMagicBytes - head_.size());
    head_.insert(head_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(wanted));
    if (!format_ && head_.size() == kMagicBytes) {
      if (auto format = recognise(); !format) return format.error();
    }
    return draft_.append(bytes);
  }

  Result<Format> recognise() {
    if (format_) return *format_;
    auto format = recognise_format(head_, declared_type_, file_name_);
    if (format) format_ = *format;
    return format;
  }

 private:
  BlobDraft& draft_;
  const std::uint64_t limit_;
  std::string declared_type_;
  std::string file_name_;
  std::uint64_t count_ = 0;
  std::vector<std::byte> head_;
  std::optional<Format> format_;
};

/// The parts of a multipart upload, in any order.
class PartSorter {
 public:
  explicit PartSorter(MeshSink& mesh) : mesh_(mesh) {}

  Result<void> begin(const PartHead& part) {
    if (part.name == "mesh" && !has_mesh_) {
      has_mesh_ = in_mesh_ = true;
      mesh_.declare(part.content_type, part.file_name);
      return {};
    }
    if (part.name == "params" && !parameters_) {
      parameters_.emplace();
      in_mesh_ = false;
      return {};
    }
    return Error{ErrorCode::bad_request,
                 "A multipart upload has exactly one part mesh and at most one part params."};
  }

  Result<void> append(std::span<const std::byte> bytes) {
    if (in_mesh_) return mesh_.append(bytes);
    if (!parameters_ || bytes.size() > kMaxParameterBytes - parameters_->size()) {
      return Error{ErrorCode::too_large, "The parameter document is too long."};
    }
    parameters_->append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return {};
  }

  bool has_mesh() const { return has_mesh_; }
  const std::optional<std::string>& parameters() const { return parameters_; }

 private:
  MeshSink& mesh_;
  bool has_mesh_ = false;
  bool in_mesh_ = false;
  std::optional<std::string> parameters_;
};

/// Returns the text of the part `params`, if there is one.
Result<std::optional<std::string>> read_multipart(BodySource& body, MeshSink& mesh) {
  PartSorter sorter(mesh);
  auto read =
      body.read_parts([&](const PartHead& part) { return sorter.begin(part); },
                      [&](std::span<const std::byte> bytes) { return sorter.append(bytes); });
  if (!read) return read.error();
  if (!sorter.has_mesh()) {
    return Error{ErrorCode::bad_request, "The multipart upload has no part named mesh."};
  }
  return sorter.parameters();
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
  if (request.content_length.value_or(0) > limit) return too_large(max_mesh_bytes);
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
  MeshSink mesh(**draft, max_mesh_bytes);
  if (is_multipart(request)) {
    auto part = read_multipart(body, mesh);
    if (!part) return part.error();
    if (*text && *part) {
      return Error{ErrorCode::bad_request, "Send params in the query or as a part, not both."};
    }
    if (*part) *text = std::move(*part);
  } else {
    mesh.declare(request.content_type, "");
    auto read = body.read([&](std::span<const std::byte> bytes) { return mesh.append(bytes); });
    if (!read) return read.error();
  }
  auto format = mesh.recognise();
  if (!format) return format.error();
  auto parameters = parse_parameters(text->value_or(""));
  if (!parameters) return parameters.error();
  return Upload{std::move(*draft), *format, std::move(*parameters)};
}

}  // namespace fairway
