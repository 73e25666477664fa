// How much of a glTF is document. Asked of its text, before a DOM is made of it.

#include "proto/formats/gltf_text.h"

#include <algorithm>

#include <fmt/format.h>

namespace fairway {
namespace {

/// Where the string that begins at `begin` ends: at its quote, or at the end of the text.
std::size_t end_of_string(std::string_view json, std::size_t begin) {
  std::size_t at = json.find_first_of("\"\\", begin);
  while (at != std::string_view::npos && json[at] == '\\') {
    at = json.find_first_of("\"\\", std::min(at + 2, json.size()));
  }
  return std::min(at, json.size());
}

}  // namespace

std::size_t size_without_payloads(std::string_view json) {
  std::size_t payloads = 0;
  for (std::size_t open = json.find('"'); open != std::string_view::npos;) {
    const std::size_t end = end_of_string(json, open + 1);
    const std::string_view text = json.substr(open + 1, end - open - 1);
    if (text.starts_with("data:") && text.size() > kUriHead) payloads += text.size() - kUriHead;
    open = json.find('"', std::min(end + 1, json.size()));
  }
  return json.size() - payloads;
}

Result<void> check_gltf_text(std::string_view json) {
  const std::size_t size = json.size() <= kMaxGltfText ? 0 : size_without_payloads(json);
  if (size <= kMaxGltfText) return {};
  return Error{ErrorCode::too_large,
               fmt::format("The glTF's JSON has {} bytes beside the payloads of its data URIs, {} "
                           "are taken; leave out what does not describe the mesh.",
                           size, kMaxGltfText)};
}

}  // namespace fairway
