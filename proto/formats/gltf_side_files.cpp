// Buffers and images of a glTF that stand in files beside it. Source: glTF 2.0 sections 3.6.1, 3.9.

#include "proto/formats/gltf_side_files.h"

#include <fmt/format.h>

#include "proto/messages/base64.h"

namespace fairway {
namespace {

/// They all end up in one file.
constexpr std::uint64_t kMaxTotal = std::uint64_t{1} << 30;
/// Of a URI in a sentence.
constexpr std::size_t kMostShown = 255;

Result<std::string> media_type(const JsonPlace& image, ByteSpan bytes) {
  const auto stated = image.text("mimeType");
  if (!stated) return stated.error();
  if (!stated->empty()) return std::string(*stated);
  const std::string_view found = image_media_type(bytes);
  return std::string(found.empty() ? "application/octet-stream" : found);
}

}  // namespace

Result<ByteSpan> SideReader::read(const JsonPlace& place, std::string_view uri) {
  if (!files_) {
    return place.error_at(
        "uri", fmt::format("fairway has no file \"{}\" and opens no addresses; embed it as a data "
                           "URI or upload it as a part of the same form.",
                           uri.substr(0, kMostShown)));
  }
  const auto path = path_of_uri(uri);
  if (!path) return place.error_at("uri", path.error().message);
  auto bytes = files_(*path);
  if (!bytes) return Error{bytes.error().code, bytes.error().message, place.pointer() + "/uri"};
  if (bytes->size() > kMaxTotal - total_) {
    return Error{ErrorCode::too_large,
                 "The files beside the document together have more than 1 GiB; make them smaller.",
                 place.pointer() + "/uri"};
  }
  total_ += bytes->size();
  return bytes;
}

Result<std::vector<SideImage>> read_side_images(const JsonPlace& root, SideReader& reader,
                                                std::vector<std::string>& notes) {
  std::vector<SideImage> out;
  if (!reader.has_files()) return out;
  const auto images = root.array("images");
  if (!images) return images.error();
  for (std::size_t i = 0; *images && i < (*images)->size(); ++i) {
    const JsonPlace image = (**images)[i];
    const auto uri = image.text("uri");
    if (!uri) return uri.error();
    if (uri->empty() || is_data_uri(*uri)) continue;
    const auto bytes = reader.read(image, *uri);
    if (!bytes && bytes.error().code == ErrorCode::too_large) return bytes.error();
    if (!bytes) {
      notes.push_back(fmt::format("images/{} stays a reference to what could not be read", i));
      continue;
    }
    auto type = media_type(image, *bytes);
    if (!type) return type.error();
    out.push_back({i, *bytes, *std::move(type)});
  }
  return out;
}

}  // namespace fairway
