#include "tests/service/support/service_process.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>

#include <catch2/catch.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "server/os/file.h"
#include "server/os/line_reader.h"
#include "tests/places.h"
#include "tests/service/support/worker_processes.h"

namespace fairway::test {
namespace {

// Sanitizers reserve terabytes of address space: no limit can hold them.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr const char* kWorkerMemory = "0";
#else
constexpr const char* kWorkerMemory = "2147483648";
#endif

UniqueFd open_or_fail(const char* path, int flags) {
  auto fd = open_file(path, flags);
  REQUIRE(fd);
  return std::move(*fd);
}

/// FAIRWAY_TEST_LOG=FILE collects what the services under test say.
UniqueFd log_file(const std::filesystem::path& chosen) {
  const char* path = chosen.empty() ? std::getenv("FAIRWAY_TEST_LOG") : chosen.c_str();
  return open_or_fail(path != nullptr ? path : "/dev/null", O_WRONLY | O_CREAT | O_APPEND);
}

/// The port in the next line of what a starting service says.
std::uint16_t announced_port(LineReader& lines, const std::string& announced) {
  std::optional<std::string> line;
  while (!(line = lines.next())) REQUIRE(lines.fill() == LineReader::Status::data);
  REQUIRE(line->starts_with(announced));
  return static_cast<std::uint16_t>(std::stoi(line->substr(line->rfind(':') + 1)));
}

}  // namespace

ServiceProcess::ServiceProcess(const std::filesystem::path& data,
                               const std::vector<std::string>& options,
                               const std::filesystem::path& log_path,
                               const std::vector<std::string>& environment) {
  std::signal(SIGPIPE, SIG_IGN);  // a client whose connection is closed hears of it by errno
  auto ends = socket_pair();
  REQUIRE(ends);
  const UniqueFd null = open_or_fail("/dev/null", O_RDONLY);
  const UniqueFd log = log_file(log_path);
  std::vector<std::string> arguments = {"--data", data.string()};
  const auto add_unless_given = [&](const char* flag, const char* value) {
    if (std::find(options.begin(), options.end(), flag) != options.end()) return;
    arguments.insert(arguments.end(), {flag, value});
  };
  add_unless_given("--listen", "127.0.0.1:0");
  add_unless_given("--worker-memory", kWorkerMemory);
  add_unless_given("--drain", "1");
  arguments.insert(arguments.end(), options.begin(), options.end());
  auto process = ChildProcess::spawn(
      {program("fairwayd"), arguments, environment, {null.get(), ends->second.get(), log.get()}});
  REQUIRE(process);
  process_.emplace(std::move(*process));
  ends->second.reset();
  LineReader lines(ends->first.get(), 1000);
  port_ = announced_port(lines, "fairwayd: listening on http://");
  if (std::find(options.begin(), options.end(), "--admin-listen") != options.end()) {
    admin_port_ = announced_port(lines, "fairwayd: administration on http://");
  }
}

void ServiceProcess::kill() {
  process_->kill(SIGKILL);
  process_->wait();
}

ExitStatus ServiceProcess::stop() {
  process_->kill(SIGTERM);
  return process_->wait();
}

std::size_t ServiceProcess::descriptors() const {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry :
       std::filesystem::directory_iterator("/proc/" + std::to_string(pid()) + "/fd")) {
    ++count;
  }
  return count;
}

/// Those that have an order.
std::vector<pid_t> ServiceProcess::workers() const {
  return children_called(kWorkingWorker, pid());
}

Refusal refused_start(const std::vector<std::string>& arguments) {
  auto ends = socket_pair();
  REQUIRE(ends);
  const UniqueFd null = open_or_fail("/dev/null", O_RDWR);
  auto process = ChildProcess::spawn(
      {program("fairwayd"), arguments, {}, {null.get(), null.get(), ends->second.get()}});
  REQUIRE(process);
  ends->second.reset();
  Refusal refusal;
  std::array<char, 1000> chunk;
  for (ssize_t got; (got = ::read(ends->first.get(), chunk.data(), chunk.size())) > 0;) {
    refusal.text.append(chunk.data(), static_cast<std::size_t>(got));
  }
  refusal.status = process->wait();
  return refusal;
}

}  // namespace fairway::test
