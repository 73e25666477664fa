#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "core/result.h"
#include "proto/messages/format.h"
#include "proto/messages/json.h"
#include "proto/messages/parameters.h"
#include "proto/messages/problem.h"

namespace fairway {

/// The conversation between fairwayd and one `fairway worker` process. The worker's descriptors:
/// 0 the input (a regular file), 1 the output (a regular file, empty at first), 2 a stream socket.
/// On the socket the server sends one WorkerOrder line; the worker sends event lines, each one JSON
/// object; any other line is log text of a library and is only logged. The last event is `Finished`
/// or `Failed`; then the worker exits with 0 or the exit code of its problem.

/// What a worker is to do with its input.
enum class Work {
  denoise,
  inspect,  ///< writes no output; the report of Finished is the inspection document
};

/// The job as the worker gets it.
struct WorkerOrder {
  Format input = Format::glb;  ///< of the mesh
  Parameters parameters;
  std::size_t files = 1;  ///< more than one: the input is a Bundle of so many files
  Work work = Work::denoise;
  std::string trace = {};  ///< 32 hexadecimal digits, for what the worker says; may be empty
};

std::string format_line(const WorkerOrder& order);
Result<WorkerOrder> parse_worker_order(std::string_view line);

/// Where a job is. `stage`: "decode", "topology", "flow", "curvature", "encode".
struct Progress {
  std::string stage;
  int step = 0;
  int of = 0;
  double fraction = 0.0;  ///< 0 … 1, never falls within one attempt
};

/// The output is complete.
struct Finished {
  Format output = Format::glb;  ///< of an inspection: that of the input
  Json report;                  ///< the job report, as in the job document; or the inspection
};

/// The job cannot be done.
struct Failed {
  Error error;
};

using WorkerEvent = std::variant<Progress, Finished, Failed>;

/// One line, with its '\n'.
std::string format_line(const WorkerEvent& event);

/// Parses one line without its '\n'. Error: malformed_input for anything that is not an event.
Result<WorkerEvent> parse_worker_event(std::string_view line);

/// Longest line either side sends or accepts, in bytes.
inline constexpr std::size_t kMaxWorkerLine = std::size_t{1} << 20;

}  // namespace fairway
