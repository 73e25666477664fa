#include "tests/bench/measured_process.h"

#include <csignal>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/os/file.h"
#include "server/os/line_reader.h"

namespace fairway::bench {
namespace {

constexpr int kEndWithinMs = 10'000;

double seconds_of_ticks(double ticks) {
  return ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// The first line of /proc/stat: all but idle (the fourth) and waiting for disks (the fifth). What
/// guests used, from the ninth on, is part of the others.
double machine_time() {
  std::ifstream in("/proc/stat");
  std::string cpu;
  in >> cpu;
  double busy = 0.0;
  double ticks = 0.0;
  for (int i = 1; i <= 8 && in >> ticks; ++i) busy += i == 4 || i == 5 ? 0.0 : ticks;
  return seconds_of_ticks(busy);
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The port that a server names while it starts.
Result<std::uint16_t> announced_port(int descriptor, const std::string& program,
                                     const std::filesystem::path& log) {
  constexpr std::string_view kSaid = "listening on http://";
  LineReader lines(descriptor, 1000);
  while (true) {
    while (const auto line = lines.next()) {
      if (line->find(kSaid) == std::string::npos) continue;
      return static_cast<std::uint16_t>(std::stoi(line->substr(line->rfind(':') + 1)));
    }
    if (lines.fill() != LineReader::Status::data) {
      return Error{ErrorCode::unavailable,
                   fmt::format("{} did not start: {}", program, text_of(log))};
    }
  }
}

}  // namespace

ProcessorTime operator-(const ProcessorTime& later, const ProcessorTime& earlier) {
  return {later.server - earlier.server, later.workers - earlier.workers,
          later.client - earlier.client, later.machine - earlier.machine};
}

Result<MeasuredProcess> MeasuredProcess::start(const std::filesystem::path& program,
                                               std::vector<std::string> arguments,
                                               const std::filesystem::path& log) {
  auto ends = socket_pair();
  if (!ends) return ends.error();
  const auto null = open_file("/dev/null", O_RDONLY);
  if (!null) return null.error();
  const auto text = open_file(log, O_WRONLY | O_CREAT | O_APPEND);
  if (!text) return text.error();
  auto process =
      ChildProcess::spawn({.program = program,
                           .arguments = std::move(arguments),
                           .environment = {},
                           .descriptors = {null->get(), ends->second.get(), text->get()}});
  if (!process) return process.error();
  ends->second.reset();
  const auto port = announced_port(ends->first.get(), program.string(), log);
  if (!port) return port.error();
  return MeasuredProcess(*std::move(process), *port);
}

MeasuredProcess::~MeasuredProcess() {
  if (process_.descriptor() < 0) return;  // moved from
  process_.kill(SIGTERM);
  pollfd ended{process_.descriptor(), POLLIN, 0};
  ::poll(&ended, 1, kEndWithinMs);  // after that it is killed
}

ProcessorTime MeasuredProcess::processor_time() const {
  ProcessorTime time;
  // The name, in parentheses, may hold anything; the state follows it as the third field.
  const std::string text = text_of(fmt::format("/proc/{}/stat", process_.pid()));
  std::istringstream fields(text.substr(text.rfind(')') + 1));
  std::string skipped;
  for (int field = 3; field < 14; ++field) fields >> skipped;
  double user = 0.0;
  double system = 0.0;
  double children_user = 0.0;
  double children_system = 0.0;
  fields >> user >> system >> children_user >> children_system;
  time.server = seconds_of_ticks(user + system);
  time.workers = seconds_of_ticks(children_user + children_system);
  rusage own{};
  ::getrusage(RUSAGE_SELF, &own);
  time.client = seconds(own.ru_utime) + seconds(own.ru_stime);
  time.machine = machine_time();
  return time;
}

std::uint64_t MeasuredProcess::resident_bytes() const {
  std::ifstream in(fmt::format("/proc/{}/status", process_.pid()));
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("VmRSS:")) return std::stoull(line.substr(6)) * 1024;
  }
  return 0;
}

}  // namespace fairway::bench
