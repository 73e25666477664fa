// `fairway worker`: one job of fairwayd. Untrusted bytes are parsed in this process only, behind
// the walls that it has closed around itself before it looks at the first of them.

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <functional>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <sys/prctl.h>
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
#include "server/fairway/worker/received_order.h"
#include "server/fairway/worker/self_test.h"
#include "server/os/file.h"
#include "server/os/kill_point.h"
#include "server/os/memory.h"
#include "server/os/sandbox.h"

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

/// For those who list processes; the tests tell workers apart by it.
void call_itself(const char* name) {
  ::prctl(PR_SET_NAME, name);
}

/// Takes the files of an order as descriptors 0 and 1 and closes all but the three.
Result<void> adopt(ReceivedOrder order) {
  if (::dup2(order.input.get(), kInput) < 0 || ::dup2(order.output.get(), kOutput) < 0) {
    return file_error("take the files of the order", errno);
  }
  return {};
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

/// The input as it is mapped, behind closed walls.
Result<void> carry_out(std::string_view line, std::span<const std::byte> input,
                       std::string& trace) {
  const Result<WorkerOrder> order = parse_worker_order(line);
  if (!order) return order.error();
  trace = order->trace;
  kill_point("order.received");
  Result<Outcome> outcome = run_order(*order, input);
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

/// Waits, confined but for the filter, until there is an order. Mapping the input reads none of it,
/// and keeps the calls for it off the filter's list. Leaves the order's trace in `trace` as soon as
/// it is known.
Result<void> work(const WorkerCommand& command, std::string& trace) {
  call_itself("fairway-idle");
  KillOrder::of_process();
  // What is written stands in memory first, so no result is larger than all of that.
  Result<Sandbox> sandbox =
      Sandbox::prepare({command.address_space, command.cpu_seconds, command.address_space});
  if (!sandbox) return sandbox.error();
  Result<ReceivedOrder> received = receive_order(kEvents);
  if (!received && received.error().code == ErrorCode::canceled) leave();
  if (!received) return received.error();
  call_itself("fairway-job");
  const std::string line = std::move(received->line);
  if (Result<void> adopted = adopt(*std::move(received)); !adopted) return adopted;
  const Result<InputFile> input = InputFile::map(kInput);
  if (!input) return input.error();
  prepare_heap(heap_estimate(input->bytes().size()));
  if (Result<void> closed = sandbox->close(); !closed) return closed;
  return carry_out(line, input->bytes(), trace);
}

Result<void> work_within_memory(const WorkerCommand& command, std::string& trace) {
  try {
    return work(command, trace);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::memory_limit,
                 "The job needs more memory than a worker may use; send a smaller mesh."};
  }
}

/// Where memory is wanting in a function that must not throw, or in telling that it is, the exit
/// code tells it.
[[noreturn]] void end_without_words() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const std::bad_alloc&) {
    _exit(problem_kind(ErrorCode::memory_limit).exit_code);
  } catch (...) {  // NOLINT(bugprone-empty-catch): the signal tells it
  }
  std::abort();
}

}  // namespace

int run(const WorkerCommand& command) {
  if (command.self_test) return test_sandbox(*command.self_test);
  std::set_terminate(end_without_words);
  std::string trace;
  const Result<void> done = work_within_memory(command, trace);
  if (done) return 0;
  log_failure(trace, done.error());
  send(Failed{done.error()});
  return problem_kind(done.error().code).exit_code;
}

}  // namespace fairway
