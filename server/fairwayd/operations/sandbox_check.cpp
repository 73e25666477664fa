#include "server/fairwayd/operations/sandbox_check.h"

#include <chrono>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <poll.h>

#include "server/os/child_process.h"
#include "server/os/line_reader.h"

namespace fairway {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kWithin{30};
constexpr milliseconds kLookForStop{50};
constexpr milliseconds kLeaveWithin{5000};
constexpr std::size_t kMaxLine = 1000;
constexpr std::string_view kFailed = "FAILED ";
constexpr std::string_view kNote = "note   ";

void add_line(std::string& to, std::string_view line) {
  if (!to.empty()) to += "; ";
  to += line;
}

void hear(LineReader& lines, SandboxCheck& check) {
  while (const auto line = lines.next()) {
    if (line->starts_with(kFailed)) add_line(check.failures, *line);
    if (line->starts_with(kNote)) add_line(check.note, line->substr(kNote.size()));
  }
}

/// Reads until the program closes its output.
Result<void> listen(int output, SandboxCheck& check, const std::stop_token& stop) {
  LineReader lines(output, kMaxLine);
  const auto until = Clock::now() + kWithin;
  while (!stop.stop_requested() && Clock::now() < until) {
    pollfd ready{output, POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(kLookForStop.count())) != 1) continue;
    const auto status = lines.fill();
    hear(lines, check);
    if (status != LineReader::Status::data) return {};
  }
  return Error{ErrorCode::unavailable, "The self-test of the sandbox did not end."};
}

}  // namespace

Result<SandboxCheck> run_self_test(const std::filesystem::path& worker,
                                   const std::stop_token& stop) {
  auto ends = socket_pair();
  if (!ends) return ends.error();
  const int output = ends->second.get();
  auto process = ChildProcess::spawn(
      {worker, {"worker", "--self-test-sandbox"}, {}, {output, output, output}});
  if (!process) return process.error();
  ends->second.reset();
  SandboxCheck check;
  if (auto heard = listen(ends->first.get(), check, stop); !heard) return heard.error();
  pollfd ended{process->descriptor(), POLLIN, 0};
  if (::poll(&ended, 1, static_cast<int>(kLeaveWithin.count())) != 1) {
    return Error{ErrorCode::unavailable, "The self-test of the sandbox does not exit."};
  }
  const ExitStatus status = process->wait();
  check.passed = status.signal == 0 && status.code == 0;
  if (!check.passed) {
    add_line(check.failures,
             fmt::format("The self-test ended with {}, signal {}.", status.code, status.signal));
  }
  return check;
}

}  // namespace fairway
