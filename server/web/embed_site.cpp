// Makes a C++ source of the files of the pages, at build time:
//   embed_site SOURCE PREFIX=FOLDER...
// The index.html of a folder gets the path PREFIX, NAME.html PREFIX/NAME, other files PREFIX/FILE.
// The program that is built has `fairway::site_files()` (server/fairwayd/site/site_file.h).

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <zlib.h>

#include "server/os/sha256.h"

namespace {

namespace fs = std::filesystem;

struct File {
  std::string media_type;
  std::string bytes;
};

std::string media_type_of(const fs::path& file) {
  static const std::map<std::string, std::string> types = {
      {".html", "text/html; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".json", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".wasm", "application/wasm"},
      {".glb", "model/gltf-binary"},
      {".webmanifest", "application/manifest+json"}};
  const auto found = types.find(file.extension().string());
  if (found == types.end()) throw std::runtime_error("no media type for " + file.string());
  return found->second;
}

std::string contents_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The URL path of a file that is `below` a folder.
std::string path_of(const std::string& prefix, const fs::path& below) {
  if (below == "index.html") return prefix.empty() ? "/" : prefix;
  fs::path shown = below;
  if (shown.extension() == ".html") shown.replace_extension();
  return prefix + "/" + shown.generic_string();
}

void add_folder(std::string_view argument, std::map<std::string, File>& files) {
  const std::size_t equals = argument.find('=');
  if (equals == std::string_view::npos) throw std::runtime_error("PREFIX=FOLDER is wanted");
  const std::string prefix(argument.substr(0, equals));
  const fs::path folder(argument.substr(equals + 1));
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string path = path_of(prefix, entry.path().lexically_relative(folder));
    const auto [at, added] =
        files.try_emplace(path, File{media_type_of(entry.path()), contents_of(entry.path())});
    if (!added) throw std::runtime_error("two files for " + path);
  }
}

std::string gzip_of(const std::string& bytes) {
  constexpr int kGzipFormat = 15 + 16;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzipFormat, 9, Z_DEFAULT_STRATEGY) !=
      Z_OK) {
    throw std::runtime_error("zlib does not start");
  }
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int status = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_STREAM_END) throw std::runtime_error("zlib does not end");
  return packed;
}

/// A string literal; three octal digits end an escape whatever follows.
void write_literal(std::ostream& out, const char* name, std::size_t n, const std::string& bytes) {
  constexpr std::size_t kLine = 4000;
  out << "constexpr char " << name << n << "[] =\n\"";
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto byte = static_cast<unsigned char>(bytes[i]);
    const bool plain = byte >= 0x20 && byte < 0x7f && byte != '"' && byte != '\\' && byte != '?';
    if (plain) {
      out << bytes[i];
    } else {
      std::array<char, 5> escape{};
      std::snprintf(escape.data(), escape.size(), "\\%03o", unsigned{byte});
      out << escape.data();
    }
    if (i % kLine == kLine - 1) out << "\"\n\"";
  }
  out << "\";\n";
}

std::string tag_of(const std::string& bytes) {
  fairway::Sha256 hash;
  hash.update(std::as_bytes(std::span(bytes)));
  return hash.hex().substr(0, 32);
}

void write_source(const std::map<std::string, File>& files, const std::string& source) {
  std::ofstream out(source, std::ios::binary);
  out << "#include \"server/fairwayd/site/site_file.h\"\n\nnamespace fairway {\nnamespace {\n\n";
  std::ostringstream table;
  std::size_t n = 0;
  for (const auto& [path, file] : files) {
    const std::string packed = gzip_of(file.bytes);
    const bool pays = packed.size() < file.bytes.size() - file.bytes.size() / 20;
    write_literal(out, "kBytes", n, file.bytes);
    if (pays) write_literal(out, "kGzip", n, packed);
    table << "    {\"" << path << "\", \"" << file.media_type << "\", {kBytes" << n << ", "
          << file.bytes.size() << "}, {";
    if (pays) table << "kGzip" << n << ", " << packed.size();
    table << "}, \"" << tag_of(file.bytes) << "\"},\n";
    ++n;
  }
  out << "constexpr SiteFile kFiles[] = {\n"
      << table.str() << "};\n\n}  // namespace\n\n"
      << "std::span<const SiteFile> site_files() {\n  return kFiles;\n}\n\n}  // namespace "
         "fairway\n";
  if (!out.flush()) throw std::runtime_error("cannot write " + source);
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 3) {
    std::fprintf(stderr, "usage: embed_site SOURCE PREFIX=FOLDER...\n");
    return 2;
  }
  try {
    std::map<std::string, File> files;
    for (int i = 2; i < count; ++i) add_folder(arguments[i], files);
    write_source(files, arguments[1]);
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "embed_site: %s\n", e.what());
    return 1;
  }
}
