#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "proto/messages/json.h"
#include "server/fairway-submit/server_address.h"

namespace fairway {

/// Exit codes of the program.
enum class SubmitExit {
  all = 0,           ///< every file has its result
  some_failed = 1,   ///< some have none, for reasons of their own
  usage = 2,         ///< nothing was started: a wrong command line, colliding names, a bad --out
  no_server = 3,     ///< the server could not be reached within --retry-for
  interrupted = 130  ///< Ctrl-C or SIGTERM
};

/// The command line.
struct SubmitOptions {
  ServerAddress server;
  std::vector<std::filesystem::path> files;
  std::filesystem::path out;
  Json parameters = Json::object();
  std::size_t concurrency = 4;          ///< uploads and jobs in flight
  std::chrono::seconds retry_for{300};  ///< how long one request is tried again
  std::vector<std::string> labels;      ///< "KEY:VALUE"
  std::string api_key;                  ///< empty: none
  std::string ca_certificate;           ///< PEM file; empty: those of the system
  bool retry_failed = false;            ///< send again what an earlier run saw fail
  bool json = false;                    ///< a summary as JSON on standard output
  bool quiet = false;                   ///< failures only
};

/// The options, or, where there is nothing to run (--help, a wrong command line, which has been
/// explained), what the program is to exit with. An API key is blotted out of `argv`, where other
/// users of the machine could read it.
std::variant<SubmitOptions, int> parse_submit_options(int argc, char** argv);

}  // namespace fairway
