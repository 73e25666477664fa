// Several files as one payload, with their directory at the end.

#include "proto/messages/bundle.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "proto/messages/json.h"

namespace fairway {
namespace {

constexpr std::string_view kMagic = "FWBUNDLE";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kFooter = 16;
/// More than 16 names of 255 bytes can need, all of them escaped.
constexpr std::size_t kMaxDirectory = std::size_t{32} << 10;

Error damaged(std::string_view why) {
  return {ErrorCode::malformed_input, fmt::format("This is no bundle of files: {}.", why)};
}

std::string little_endian(std::uint32_t value) {
  std::string out;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    out += static_cast<char>(static_cast<unsigned char>(value >> shift & 0xFFU));
  }
  return out;
}

/// Of at least four bytes.
std::uint32_t load_u32(std::string_view text) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8U | static_cast<unsigned char>(text[i]);
  return value;
}

/// nlohmann replaces what is not UTF-8 when it writes, and reads only UTF-8.
bool is_utf8(std::string_view text) {
  const auto back = parse_json(dump_json(Json(text)));
  return back && back->get_ref<const std::string&>() == text;
}

/// The directory's text; behind it stands only the footer.
Result<std::string_view> find_directory(std::string_view bundle) {
  if (bundle.size() < kFooter) return damaged("it ends inside its footer");
  const std::string_view footer = bundle.substr(bundle.size() - kFooter);
  if (!footer.starts_with(kMagic)) return damaged("it has another footer");
  if (load_u32(footer.substr(8)) != kVersion) return damaged("its version is not known");
  const std::size_t length = load_u32(footer.substr(12));
  if (length > kMaxDirectory || length > bundle.size() - kFooter) {
    return damaged("its directory is longer than it can be");
  }
  return bundle.substr(bundle.size() - kFooter - length, length);
}

/// One file of the directory, whose bytes are the first ones of `rest`.
Result<BundledFile> take_file(const Json& entry, std::span<const std::byte> rest) {
  if (!entry.is_object() || entry.size() != 2 || !entry.contains("name") ||
      !entry.contains("bytes") || !entry["name"].is_string() ||
      !entry["bytes"].is_number_unsigned()) {
    return damaged("a file of its directory has no name or no length");
  }
  const auto& name = entry["name"].get_ref<const std::string&>();
  if (!check_bundle_name(name)) return damaged("a file of its directory has an impossible name");
  const auto bytes = entry["bytes"].get<std::uint64_t>();
  if (bytes > rest.size()) return damaged("its files are longer than it is");
  return BundledFile{name, rest.first(static_cast<std::size_t>(bytes))};
}

Result<Json> parse_directory(std::string_view text) {
  auto directory = parse_json(text);
  if (!directory) return damaged("its directory is no JSON");
  if (!directory->is_object() || directory->size() != 2 || !directory->contains("mesh") ||
      !directory->contains("files") || !(*directory)["mesh"].is_number_unsigned() ||
      !(*directory)["files"].is_array()) {
    return damaged("its directory does not say which files there are");
  }
  const std::size_t count = (*directory)["files"].size();
  if (count == 0 || count > kMaxBundleFiles) return damaged("it has no files or too many");
  if ((*directory)["mesh"].get<std::uint64_t>() >= count) return damaged("its mesh is no file");
  return directory;
}

}  // namespace

Result<void> check_bundle_name(std::string_view name) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
  if (name.empty() || name.size() > kMaxBundleName) {
    return Error{ErrorCode::bad_request,
                 fmt::format("The name of a part has 1 to {} bytes; rename it.", kMaxBundleName)};
  }
  if (std::any_of(name.begin(), name.end(), is_control) || !is_utf8(name)) {
    return Error{ErrorCode::bad_request,
                 "The name of a part is UTF-8 without control characters; rename it."};
  }
  return {};
}

std::string bundle_end(std::span<const BundleEntry> files, std::size_t mesh) {
  Json list = Json::array();
  for (const BundleEntry& file : files) {
    list.push_back({{"name", file.name}, {"bytes", file.bytes}});
  }
  std::string out = dump_json({{"mesh", mesh}, {"files", std::move(list)}});
  const auto length = static_cast<std::uint32_t>(out.size());
  return out.append(kMagic).append(little_endian(kVersion)).append(little_endian(length));
}

Result<Bundle> Bundle::parse(std::span<const std::byte> bytes) {
  const auto text = find_directory({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!text) return text.error();
  const auto directory = parse_directory(*text);
  if (!directory) return directory.error();
  std::span<const std::byte> rest = bytes.first(bytes.size() - kFooter - text->size());
  Bundle bundle;
  for (const Json& entry : (*directory)["files"]) {
    auto file = take_file(entry, rest);
    if (!file) return file.error();
    rest = rest.subspan(file->bytes.size());
    for (const BundledFile& other : bundle.files_) {
      if (other.name == file->name) return damaged("two of its files have one name");
    }
    bundle.files_.push_back(*std::move(file));
  }
  if (!rest.empty()) return damaged("it is longer than its files");
  bundle.mesh_ = static_cast<std::size_t>((*directory)["mesh"].get<std::uint64_t>());
  return bundle;
}

}  // namespace fairway
