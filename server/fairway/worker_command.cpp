// `fairway worker`: one job of fairwayd. Untrusted bytes are parsed in this process only, under the
// limits it sets for itself before it looks at the first of them.

#include <algorithm>
#include <functional>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "proto/messages/problem.h"
#include "proto/messages/worker_protocol.h"
#include "server/fairway/bundled_files.h"
#include "server/fairway/commands.h"
#include "server/fairway/input_file.h"
#include "server/fairway/inspect.h"
#include "server/fairway/pipeline.h"
#include "server/fairway/progress_pace.h"
#include "server/os/file.h"
#include "server/os/kill_point.h"
#include "server/os/line_reader.h"
#include "server/os/memory.h"

namespace fairway {
namespace {

constexpr int kInput = 0;
constexpr int kOutput = 1;
constexpr int kEvents = 2;
constexpr std::size_t kMaxLogLine = 400;

/// The server is gone: nobody wants the result any more.
[[noreturn]] void leave() {
  _exit(problem_kind(ErrorCode::canceled).exit_code);
}

void send(const std::string& line) {
  for (std::span<const char> rest = line; !rest.empty();) {
    const ssize_t sent = ::send(kEvents, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) leave();
    rest = rest.subspan(static_cast<std::size_t>(sent));
  }
}

void send(const WorkerEvent& event) {
  send(format_line(event));
}

/// No limit where `soft` is 0.
bool limit(__rlimit_resource resource, std::uint64_t soft, std::uint64_t hard) {
  const rlimit both = {soft, hard};
  return soft == 0 || setrlimit(resource, &both) == 0;
}

Result<void> confine(const WorkerCommand& command) {
  // At the soft limit of processor time a signal says so, a second later the process is killed.
  const bool confined = prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 &&
                        prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                        limit(RLIMIT_AS, command.address_space, command.address_space) &&
                        limit(RLIMIT_CPU, command.cpu_seconds, command.cpu_seconds + 1);
  const rlimit no_core = {0, 0};
  if (!confined || setrlimit(RLIMIT_CORE, &no_core) != 0) {
    return Error{ErrorCode::internal, "The worker cannot confine itself."};
  }
  return {};
}

Result<WorkerOrder> receive_order() {
  LineReader reader(kEvents, kMaxWorkerLine);
  for (;;) {
    if (const auto line = reader.next()) return parse_worker_order(*line);
    if (reader.fill() != LineReader::Status::data) leave();
  }
}

/// What an order came to; an inspection writes nothing.
struct Outcome {
  ByteChain bytes;
  Format format;
  Json report;
};

/// `notes`: those about the files of the upload, once all that is asked for has been.
Result<Outcome> run_on(std::span<const std::byte> mesh, const WorkerOrder& order,
                       const SideFiles& side_files,
                       const std::function<std::vector<std::string>()>& notes) {
  ProgressPace pace;
  const ProgressObserver observer = [&pace](const Progress& progress) {
    if (pace.admits(progress)) send(progress);
  };
  const auto append = [&notes](std::vector<std::string>& to) {
    for (std::string& note : notes()) to.push_back(std::move(note));
  };
  if (order.work == Work::inspect) {
    Result<Inspection> found = inspect(mesh, order.input, observer, side_files);
    if (!found) return found.error();
    append(found->notes);
    return Outcome{{}, order.input, inspection_document(*found)};
  }
  Result<PipelineOutput> output =
      run_pipeline(mesh, order.input, order.parameters, observer, {}, side_files);
  if (!output) return output.error();
  append(output->report.notes);
  return Outcome{std::move(output->bytes), output->format, report_document(output->report)};
}

Result<Outcome> run_bundle(const WorkerOrder& order, std::span<const std::byte> input) {
  Result<Bundle> bundle = Bundle::parse(input);
  if (!bundle) return Error{ErrorCode::internal, bundle.error().message};
  if (bundle->files().size() != order.files) {
    return Error{ErrorCode::internal, "The stored upload has another number of files."};
  }
  BundledFiles files(*std::move(bundle));
  return run_on(files.mesh(), order, files.provider(), [&files] { return files.notes(); });
}

Result<Outcome> run_order(const WorkerOrder& order, std::span<const std::byte> input) {
  if (order.files > 1) return run_bundle(order, input);
  return run_on(input, order, {}, [] { return std::vector<std::string>(); });
}

/// A line of no event is one of the log. Nothing is said of an order without a trace.
void log_failure(const std::string& trace, const Error& error) {
  if (trace.empty()) return;
  const std::string text = fmt::format("trace {}: {}: {} {}", trace, problem_kind(error.code).slug,
                                       error.message, error.pointer);
  std::string line = text.substr(0, kMaxLogLine);
  std::replace(line.begin(), line.end(), '\n', ' ');
  send(line + "\n");
}

/// Leaves the order's trace in `trace` as soon as it is known.
Result<void> work(const WorkerCommand& command, std::string& trace) {
  if (Result<void> confined = confine(command); !confined) return confined;
  const Result<WorkerOrder> order = receive_order();
  if (!order) return order.error();
  trace = order->trace;
  kill_point("order.received");
  const Result<InputFile> input = InputFile::map(kInput);
  if (!input) return input.error();
  prepare_heap(heap_estimate(input->bytes().size()));
  Result<Outcome> outcome = run_order(*order, input->bytes());
  if (!outcome) return outcome.error();
  kill_point("output.write");
  if (Result<void> written = write_all(kOutput, outcome->bytes.pieces()); !written) {
    return written;
  }
  kill_point("output.written");
  send(Finished{outcome->format, std::move(outcome->report)});
  kill_point("finish.told");
  return {};
}

Result<void> work_within_memory(const WorkerCommand& command, std::string& trace) {
  try {
    return work(command, trace);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::memory_limit,
                 "The job needs more memory than a worker may use; send a smaller mesh."};
  }
}

}  // namespace

int run(const WorkerCommand& command) {
  std::string trace;
  const Result<void> done = work_within_memory(command, trace);
  if (done) return 0;
  log_failure(trace, done.error());
  send(Failed{done.error()});
  return problem_kind(done.error().code).exit_code;
}

}  // namespace fairway
