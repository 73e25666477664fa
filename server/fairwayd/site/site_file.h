#pragma once

#include <span>
#include <string_view>

namespace fairway {

/// A file of the pages that the service shows, as the build put it into the program.
struct SiteFile {
  std::string_view path;        ///< "/", "/docs/style.css"
  std::string_view media_type;  ///< with its charset
  std::string_view bytes;
  std::string_view gzip;  ///< the same compressed; empty where that saves nothing
  std::string_view tag;   ///< of its bytes, for an ETag, without quotes
};

/// All of them, ordered by path: the page (server/web), its samples, the documentation. Written by
/// server/web/embed_site.cpp when the service is built.
std::span<const SiteFile> site_files();

}  // namespace fairway
