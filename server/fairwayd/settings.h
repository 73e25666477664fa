#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/result.h"
#include "server/fairwayd/http_server.h"

namespace fairway {

/// The command line of fairwayd.
struct Settings {
  ListenAddress listen;
  std::filesystem::path data;
  std::size_t workers = 1;                               ///< jobs at a time
  std::size_t queue = 256;                               ///< jobs that may wait
  std::uint64_t max_body = std::uint64_t{512} << 20;     ///< bytes of one mesh
  std::chrono::seconds deadline{300};                    ///< of one job, wall clock
  std::uint64_t worker_memory = std::uint64_t{4} << 30;  ///< address space in bytes; 0 = any
  std::filesystem::path worker;                          ///< empty: beside fairwayd
  bool help = false;
  bool version = false;
};

/// Reads the arguments after the program's name. Errors: usage.
Result<Settings> parse_settings(std::span<const char* const> arguments);

/// What --help prints.
std::string usage_text();

}  // namespace fairway
