#include "server/fairway-submit/payload.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "proto/messages/format.h"
#include "server/fairway-submit/scene_files.h"
#include "server/os/file.h"
#include "server/os/random_id.h"
#include "server/os/sha256.h"

namespace fairway {
namespace {

constexpr std::size_t kLongestQuery = 4000;
/// A .gltf beyond this is sent as it is: what it would name could not be looked for.
constexpr std::uint64_t kLongestScene = std::uint64_t{512} << 20;

Result<UniqueFd> open_regular(const std::filesystem::path& path) {
  // Without O_NONBLOCK a pipe would make us wait before it is found to be no regular file.
  auto file = open_file(path, O_RDONLY | O_NONBLOCK);
  if (!file) return file;
  struct stat status {};
  if (::fstat(file->get(), &status) != 0) return file_error("look at " + path.string(), errno);
  if (!S_ISREG(status.st_mode)) {
    return Error{ErrorCode::io, fmt::format("{} is not a regular file.", path.string())};
  }
  return file;
}

/// What a form or a URL can say of the file.
std::string_view type_of(const std::filesystem::path& path) {
  return media_type_of(format_of_file_name(path.string()).value_or(Format::drc));
}

std::string part_head(std::string_view boundary, std::string_view name, std::string_view file,
                      std::string_view type) {
  std::string head =
      fmt::format("--{}\r\nContent-Disposition: form-data; name=\"{}\"", boundary, name);
  if (!file.empty()) head += fmt::format("; filename=\"{}\"", file);
  if (!type.empty()) head += fmt::format("\r\nContent-Type: {}", type);
  return head + "\r\n\r\n";
}

/// A name for the server to tell the format by; the rest of it need not travel.
std::string file_name_of(const std::filesystem::path& input) {
  const auto format = format_of_file_name(input.string());
  return format ? fmt::format("mesh.{}", name_of(*format)) : "mesh";
}

Result<std::vector<SceneFile>> scene_files_of(const std::filesystem::path& input, int file) {
  const auto bytes = size_of(file);
  if (!bytes) return bytes.error();
  if (format_of_file_name(input.string()) != Format::gltf || *bytes > kLongestScene) {
    return std::vector<SceneFile>();
  }
  std::string text(*bytes, '\0');
  std::size_t at = 0;
  while (at < text.size()) {
    const ssize_t got = ::pread(file, text.data() + at, text.size() - at, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return file_error("read " + input.string(), errno);
    if (got == 0) break;
    at += static_cast<std::size_t>(got);
  }
  text.resize(at);
  return open_scene_files(input, text);
}

}  // namespace

std::string url_encoded(std::string_view text) {
  std::string encoded;
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    encoded += std::isalnum(u) != 0 ? std::string(1, c) : fmt::format("%{:02X}", u);
  }
  return encoded;
}

void Payload::add(std::string text) {
  const std::uint64_t bytes = text.size();
  pieces_.push_back({std::move(text), {}, size_, bytes});
  size_ += bytes;
}

/// Returns the digest of the file.
Result<std::string> Payload::add(UniqueFd file) {
  const auto bytes = size_of(file.get());
  if (!bytes) return bytes.error();
  auto sha256 = sha256_of_file(file.get());
  if (!sha256) return sha256;
  pieces_.push_back({{}, std::move(file), size_, *bytes});
  size_ += *bytes;
  return sha256;
}

Result<Payload> Payload::open(const std::filesystem::path& input, const Json& parameters) {
  auto mesh = open_regular(input);
  if (!mesh) return mesh.error();
  auto others = scene_files_of(input, mesh->get());
  if (!others) return others.error();
  Payload payload;
  const std::string parameter_text = dump_json(parameters);
  const std::string encoded = url_encoded(parameter_text);
  std::string identity = parameter_text;
  if (others->empty() && encoded.size() <= kLongestQuery) {
    payload.content_type_ = type_of(input);
    payload.query_ = "?params=" + encoded;
    auto sha256 = payload.add(*std::move(mesh));
    if (!sha256) return sha256.error();
    identity += fmt::format("\n{} {}", payload.content_type_, *sha256);
    payload.input_sha256_ = *std::move(sha256);
  } else {
    const std::string boundary = random_id();
    payload.content_type_ = "multipart/form-data; boundary=" + boundary;
    payload.add(part_head(boundary, "params", "", "application/json") + parameter_text + "\r\n");
    others->insert(others->begin(), {file_name_of(input), *std::move(mesh)});
    for (SceneFile& file : *others) {
      const bool is_mesh = &file == &others->front();
      payload.add(part_head(boundary, is_mesh ? "mesh" : "file", file.name,
                            is_mesh ? type_of(input) : "application/octet-stream"));
      auto sha256 = payload.add(std::move(file.file));
      if (!sha256) return sha256.error();
      payload.add("\r\n");
      identity += fmt::format("\n{} {}", file.name, *sha256);
      payload.input_sha256_ = others->size() == 1 ? *sha256 : "";
    }
    payload.add(fmt::format("--{}--\r\n", boundary));
  }
  Sha256 digest;
  digest.update(std::as_bytes(std::span(identity)));
  payload.digest_ = digest.hex();
  return payload;
}

Result<std::size_t> Payload::read(std::uint64_t offset, std::span<char> space) const {
  const auto after = std::find_if(pieces_.begin(), pieces_.end(), [offset](const Piece& piece) {
    return offset < piece.begin + piece.bytes;
  });
  if (after == pieces_.end()) return std::size_t{0};
  const std::uint64_t inside = offset - after->begin;
  const auto count =
      static_cast<std::size_t>(std::min<std::uint64_t>(space.size(), after->bytes - inside));
  if (!after->file) {
    after->text.copy(space.data(), count, static_cast<std::size_t>(inside));
    return count;
  }
  ssize_t got = -1;
  do {
    got = ::pread(after->file.get(), space.data(), count, static_cast<off_t>(inside));
  } while (got < 0 && errno == EINTR);
  if (got < 0) return file_error("read a file that is sent", errno);
  return static_cast<std::size_t>(got);
}

}  // namespace fairway
