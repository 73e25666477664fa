#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "server/fairwayd/http/http_server.h"

namespace fairway {

/// Whether callers must have a key.
enum class AuthMode : std::uint8_t {
  automatic,  ///< no, but then the service is refused to listen beyond this machine
  keys,
  none,
};

/// What fairwayd runs with. Every value has a row in setting_table.cpp, which names it.
struct Settings {
  ListenAddress listen;
  std::optional<ListenAddress> admin_listen;  ///< a listener of its own for metrics
  std::filesystem::path data;
  std::size_t workers = 1;  ///< jobs at a time
  AuthMode auth = AuthMode::automatic;
  std::vector<std::string> cors_origins;                 ///< see CrossOrigin
  std::size_t queue = 256;                               ///< jobs that may wait
  std::uint64_t rate = 0;                                ///< submits a minute of a tenant; 0 = any
  std::uint64_t quota = 0;                               ///< bytes kept of a tenant; 0 = any
  std::uint64_t max_body = std::uint64_t{512} << 20;     ///< bytes of one mesh
  std::chrono::seconds deadline{300};                    ///< of one job, wall clock
  std::chrono::seconds keep{86'400};                     ///< meshes, after a job's end
  std::chrono::seconds upload_keep{86'400};              ///< uploads, after their last bytes
  std::chrono::seconds forget{30 * 86'400};              ///< the job itself, after its end
  std::uint64_t worker_memory = std::uint64_t{4} << 30;  ///< address space in bytes; 0 = any
  std::uint64_t min_free = std::uint64_t{1} << 30;       ///< bytes left on the disk of `data`
  std::chrono::seconds lease{30};                        ///< how long a server may be silent
  std::chrono::seconds drain{10};                        ///< for running jobs, at a stop
  std::filesystem::path worker;                          ///< empty: beside fairwayd
  bool webhook_allow_private = false;                    ///< addresses that are not public
  std::chrono::seconds webhook_retry{5};                 ///< until a webhook is tried again

  bool help = false;
  bool version = false;
  bool print_config = false;
  bool health = false;

  std::vector<std::string> origins;  ///< of each row of the table: "default", "--workers", "FILE:3"
  std::vector<std::string> unknown_variables;  ///< FAIRWAY_… that mean nothing here
};

/// Reads flags, FAIRWAY_… variables and the file that --config or FAIRWAY_CONFIG names; what comes
/// earlier in this list wins, and an empty variable is none. `arguments`: those after the program's
/// name; `environment`: "NAME=value". Errors: usage (with the flag, variable or line of the
/// culprit, also where another value wins over it), io (the file cannot be read).
Result<Settings> parse_settings(std::span<const char* const> arguments,
                                std::span<const std::string> environment = {});

/// The settings in force as a file that --config takes, each below a comment on where it came from.
std::string print_settings(const Settings& settings);

/// What --help prints.
std::string usage_text();

}  // namespace fairway
