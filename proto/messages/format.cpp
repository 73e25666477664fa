// Which format some bytes are, and what each format is called.

#include "proto/messages/format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include <fmt/format.h>

#include "proto/messages/shape_guess.h"

namespace fairway {
namespace {

struct FormatRow {
  Format format;
  std::string_view name;
  std::string_view media_type;
};

constexpr std::array kFormats = {
    FormatRow{Format::glb, "glb", "model/gltf-binary"},
    FormatRow{Format::gltf, "gltf", "model/gltf+json"},
    FormatRow{Format::drc, "drc", "application/octet-stream"},
    FormatRow{Format::ply, "ply", "model/ply"},
    FormatRow{Format::obj, "obj", "model/obj"},
    FormatRow{Format::stl, "stl", "model/stl"},
};

struct TypeRow {
  std::string_view media_type;
  Format format;
};

/// What clients declare.
constexpr std::array kTypes = {
    TypeRow{"model/gltf-binary", Format::glb},
    TypeRow{"model/gltf+json", Format::gltf},
    TypeRow{"model/ply", Format::ply},
    TypeRow{"model/x-ply", Format::ply},
    TypeRow{"application/ply", Format::ply},
    TypeRow{"application/x-ply", Format::ply},
    TypeRow{"model/obj", Format::obj},
    TypeRow{"text/prs.wavefront-obj", Format::obj},
    TypeRow{"model/stl", Format::stl},
    TypeRow{"model/x.stl-ascii", Format::stl},
    TypeRow{"model/x.stl-binary", Format::stl},
    TypeRow{"application/sla", Format::stl},
    TypeRow{"application/vnd.ms-pki.stl", Format::stl},
};

constexpr std::string_view kAnyBytes = "application/octet-stream";
constexpr std::string_view kTake =
    "Send GLB as model/gltf-binary, glTF as model/gltf+json, PLY, OBJ or STL as model/ply, "
    "model/obj or model/stl, or any of them and Draco as application/octet-stream.";

const FormatRow& row_of(Format format) {
  return kFormats[static_cast<std::size_t>(format)];
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

Error unsupported(std::string what) {
  return {ErrorCode::unsupported_format, fmt::format("{} {}", what, kTake)};
}

/// The media type without parameters, lower case, trimmed.
std::string bare_type(std::string_view declared) {
  std::string type = lower(declared.substr(0, declared.find(';')));
  const auto space = [](unsigned char c) { return std::isspace(c) != 0; };
  type.erase(type.begin(), std::find_if_not(type.begin(), type.end(), space));
  type.erase(std::find_if_not(type.rbegin(), type.rend(), space).base(), type.end());
  return type;
}

bool starts_with(std::span<const std::byte> head, std::string_view magic) {
  return head.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), head.begin(),
                    [](char a, std::byte b) { return std::byte(a) == b; });
}

/// A first byte of '{' after white space and a byte order mark.
bool looks_like_json(std::span<const std::byte> head) {
  if (starts_with(head, "\xEF\xBB\xBF")) head = head.subspan(3);
  for (const std::byte b : head) {
    const char c = static_cast<char>(b);
    if (c == '{' || c == '[') return true;
    if (c != ' ' && c != '\t' && c != '\r' && c != '\n') return false;
  }
  return false;
}

std::optional<Format> by_magic(std::span<const std::byte> head) {
  if (starts_with(head, "glTF")) return Format::glb;
  if (starts_with(head, "DRACO")) return Format::drc;
  if (starts_with(head, "ply\n") || starts_with(head, "ply\r")) return Format::ply;
  if (looks_like_json(head)) return Format::gltf;
  return std::nullopt;
}

bool has_no_magic(Format format) {
  return format == Format::obj || format == Format::stl;
}

std::optional<Format> by_type(std::string_view type) {
  const auto* row = std::find_if(kTypes.begin(), kTypes.end(),
                                 [type](const TypeRow& r) { return r.media_type == type; });
  if (row == kTypes.end()) return std::nullopt;
  return row->format;
}

/// Browsers and mail programs guess the type of a file by its name, and do not know ours: Chromium
/// on Debian takes .obj for a drawing (application/x-tgif), others .stl for a list of certificates.
bool may_be_guessed(std::string_view type) {
  constexpr std::array<std::string_view, 3> kKinds = {"application/", "text/", "model/"};
  return std::any_of(kKinds.begin(), kKinds.end(),
                     [type](std::string_view kind) { return type.starts_with(kind); });
}

bool is_cut_magic(std::span<const std::byte> head) {
  constexpr std::array<std::string_view, 3> kMagics = {"glTF", "DRACO", "ply\n"};
  return std::any_of(kMagics.begin(), kMagics.end(), [head](std::string_view magic) {
    return head.size() < magic.size() && starts_with(head, magic.substr(0, head.size()));
  });
}

Result<Format> check_version(Format format, std::span<const std::byte> head) {
  const auto at = [head](std::size_t i) { return std::to_integer<unsigned>(head[i]); };
  if (format == Format::glb && head.size() >= 8) {
    const unsigned version = at(4) | at(5) << 8U | at(6) << 16U | at(7) << 24U;
    if (version != 2) {
      return unsupported(fmt::format("This is GLB version {}, fairway reads version 2.", version));
    }
  }
  if (format == Format::drc && head.size() >= 7) {
    const unsigned major = at(5);
    const unsigned minor = at(6);
    if (major > 2 || (major == 2 && minor > 2)) {
      return unsupported(
          fmt::format("This is Draco version {}.{}, fairway reads up to 2.2.", major, minor));
    }
  }
  return format;
}

}  // namespace

std::string_view name_of(Format format) {
  return row_of(format).name;
}

std::string_view media_type_of(Format format) {
  return row_of(format).media_type;
}

std::optional<Format> format_of_name(std::string_view name) {
  const auto* it = std::find_if(kFormats.begin(), kFormats.end(),
                                [name](const FormatRow& row) { return row.name == name; });
  if (it == kFormats.end()) return std::nullopt;
  return it->format;
}

std::optional<Format> format_of_file_name(std::string_view file_name) {
  const std::size_t dot = file_name.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  return format_of_name(lower(file_name.substr(dot + 1)));
}

Result<Format> recognise_format(std::span<const std::byte> head, std::string_view declared_type,
                                std::string_view file_name) {
  const std::string type = bare_type(declared_type);
  const std::optional<Format> declared = by_type(type);
  const std::optional<Format> named = format_of_file_name(file_name);
  if (!declared && !type.empty() && type != kAnyBytes && !(named && may_be_guessed(type))) {
    return unsupported("The declared content type is not a mesh type fairway takes.");
  }
  if (head.empty()) {
    return Error{ErrorCode::malformed_input, "The upload is empty; send the bytes of a mesh file."};
  }
  const std::optional<Format> told = declared ? declared : named;
  std::optional<Format> found = by_magic(head);
  if (!found && told && has_no_magic(*told)) return *told;
  if (!found && is_cut_magic(head)) {
    return Error{ErrorCode::malformed_input,
                 "The upload ends inside the first bytes of its format; send the whole file."};
  }
  if (!found) found = guess_shape(head);
  if (declared && found != declared) {
    return unsupported(
        fmt::format("The content type says {}, the bytes are not.", name_of(*declared)));
  }
  if (found && !declared && named && found != named) {
    return unsupported(
        fmt::format("The file is named .{}, its bytes are {}.", name_of(*named), name_of(*found)));
  }
  if (found) return check_version(*found, head);
  return unsupported("These bytes are no mesh format fairway reads.");
}

}  // namespace fairway
