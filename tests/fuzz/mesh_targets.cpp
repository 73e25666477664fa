// The readers of mesh files.

#include <algorithm>

#include <fmt/format.h>

#include "proto/formats/bytes.h"
#include "proto/messages/format.h"
#include "tests/fuzz/mesh_job.h"
#include "tests/fuzz/targets.h"

namespace fairway::test {
namespace {

/// A path that a provider may open below its folder.
bool stays_below(std::string_view path) {
  while (true) {
    const std::size_t end = std::min(path.find('/'), path.size());
    const std::string_view name = path.substr(0, end);
    if (name.empty() || name == "." || name == "..") return false;
    if (name.find('\\') != std::string_view::npos) return false;
    if (std::any_of(name.begin(), name.end(), [](char c) { return c >= 0 && c < ' '; })) {
      return false;
    }
    if (end == path.size()) return true;
    path.remove_prefix(end + 1);
  }
}

/// 144 bytes beside the document: enough for the corners of a cube and some indices.
std::vector<std::byte> side_bytes() {
  std::vector<std::byte> out;
  for (unsigned i = 0; i < 8; ++i) {
    for (const unsigned bit : {1U, 2U, 4U}) append_value(out, (i & bit) != 0 ? 1.0F : 0.0F);
  }
  for (const std::uint32_t index : {0U, 2U, 1U, 1U, 2U, 3U, 4U, 5U, 6U, 5U, 7U, 6U}) {
    append_value(out, index);
  }
  return out;
}

}  // namespace

std::string fuzz_glb(ByteSpan bytes) {
  return mesh_job_defect(bytes, Format::glb);
}

std::string fuzz_gltf(ByteSpan bytes) {
  const std::vector<std::byte> beside = side_bytes();
  std::string escape;
  const SideFiles files = [&](const std::string& path) -> Result<ByteSpan> {
    if (!stays_below(path)) escape = "a side file outside the folder was asked for: " + path;
    if (path == "side.bin") return ByteSpan(beside);
    return Error{ErrorCode::io, "There is no such file beside the document."};
  };
  const std::string defect = mesh_job_defect(bytes, Format::gltf, files);
  return escape.empty() ? defect : escape;
}

std::string fuzz_drc(ByteSpan bytes) {
  return mesh_job_defect(bytes, Format::drc);
}

std::string fuzz_ply(ByteSpan bytes) {
  return mesh_job_defect(bytes, Format::ply);
}

std::string fuzz_obj(ByteSpan bytes) {
  return mesh_job_defect(bytes, Format::obj);
}

std::string fuzz_stl(ByteSpan bytes) {
  return mesh_job_defect(bytes, Format::stl);
}

std::string fuzz_recognition(ByteSpan bytes) {
  // The first line stands for what a client declares, "type;name".
  const std::string_view text = as_text(bytes);
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  const std::size_t mark = std::min(line.find(';'), line.size());
  const std::string_view name = line.substr(std::min(mark + 1, line.size()));
  const ByteSpan head = bytes.subspan(std::min(end + 1, bytes.size()));
  const auto format =
      recognise_format(head.first(std::min(head.size(), kMagicBytes)), line.substr(0, mark), name);
  if (!format) return refusal_defect(format.error());
  const auto again =
      recognise_format(head.first(std::min(head.size(), kMagicBytes)), media_type_of(*format),
                       fmt::format("mesh.{}", name_of(*format)));
  if (!again) return "recognised, but not when it is called what it is: " + again.error().message;
  return *again == *format ? "" : "called what it was recognised as, it becomes another format";
}

}  // namespace fairway::test
