#include "tests/hostile/target.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <sys/wait.h>

#include "proto/messages/json.h"
#include "tests/hostile/wire.h"

namespace fairway::hostile {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr double kNoAnswer = 1e9;
constexpr milliseconds kTick{10};

/// A field of /proc/PID/status, in KiB; 0 where the process is gone.
long status_field(pid_t pid, const std::string& name) {
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(name)) return std::strtol(line.c_str() + name.size(), nullptr, 10);
  }
  return 0;
}

std::vector<pid_t> children_of(pid_t pid) {
  std::vector<pid_t> found;
  std::error_code gone;
  for (const auto& task :
       std::filesystem::directory_iterator(fmt::format("/proc/{}/task", pid), gone)) {
    std::ifstream children(task.path() / "children");
    for (pid_t child; children >> child;) found.push_back(child);
  }
  return found;
}

long resident_below(pid_t pid) {
  long sum = status_field(pid, "VmRSS:");
  for (const pid_t child : children_of(pid)) sum += resident_below(child);
  return sum;
}

bool is_own_name(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '.' || c == '-' || c == '_';
  });
}

std::string fault_of_line(const std::string& line) {
  const bool plain =
      std::none_of(line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  if (!plain) return "a log line with control characters: " + line;
  const auto json = parse_json(line);
  if (!json || !json->is_object()) return "a log line that is no JSON object: " + line;
  return {};
}

}  // namespace

Target::Target(const std::vector<std::string>& options)
    : log_(directory_.path() / "service.log"),
      service_(directory_.path() / "data", options, log_) {}

Target::~Target() {
  if (is_alive()) service_.kill();
}

bool Target::is_alive() const {
  siginfo_t ended{};
  const int asked =
      ::waitid(P_PID, static_cast<id_t>(service_.pid()), &ended, WEXITED | WNOHANG | WNOWAIT);
  return asked == 0 && ended.si_pid == 0;
}

long Target::resident() const {
  return resident_below(service_.pid());
}

long Target::peak() const {
  return status_field(service_.pid(), "VmHWM:");
}

std::string Target::new_log() {
  std::ifstream file(log_, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(log_read_));
  std::string text((std::istreambuf_iterator<char>(file)), {});
  text.resize(text.rfind('\n') + 1);  // a line that is being written comes next time
  log_read_ += text.size();
  return text;
}

std::string Target::traces_of_input() {
  std::istringstream lines(new_log());
  for (std::string line; std::getline(lines, line);) {
    if (std::string fault = fault_of_line(line); !fault.empty()) return fault;
  }
  std::error_code gone;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(directory_.path() / "data", gone)) {
    const std::string name = entry.path().filename();
    if (!is_own_name(name)) return "a file that is named by a client: " + name;
  }
  return {};
}

LivenessProbe::LivenessProbe(std::uint16_t port, milliseconds pause)
    : port_(port),
      pause_(pause),
      clock_([this](const std::stop_token& stop) { watch_clock(stop); }),
      asker_([this](const std::stop_token& stop) { ask(stop); }) {}

void LivenessProbe::ask(const std::stop_token& stop) {
  const test::HttpClient client(port_);
  while (!stop.stop_requested()) {
    const auto began = steady_clock::now();
    {
      const std::lock_guard lock(mutex_);
      asked_ = began;
      open_ = true;
    }
    const bool alive = client.get("/livez").status == 200;
    {
      const std::lock_guard lock(mutex_);
      if (open_) times_.push_back(alive ? milliseconds_since(began) : kNoAnswer);
      open_ = false;
    }
    std::this_thread::sleep_for(pause_);
  }
}

void LivenessProbe::watch_clock(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto began = steady_clock::now();
    std::this_thread::sleep_for(kTick);
    const double late = milliseconds_since(began) - static_cast<double>(kTick.count());
    const std::lock_guard lock(mutex_);
    stall_ = std::max(stall_, late);
  }
}

void LivenessProbe::restart() {
  const std::lock_guard lock(mutex_);
  times_.clear();
  open_ = false;
  stall_ = 0.0;
}

std::vector<double> LivenessProbe::times() const {
  const std::lock_guard lock(mutex_);
  return times_;
}

double LivenessProbe::longest() const {
  const std::lock_guard lock(mutex_);
  double most = open_ ? milliseconds_since(asked_) : 0.0;
  for (const double time : times_) most = std::max(most, time);
  return most;
}

double LivenessProbe::longest_stall() const {
  const std::lock_guard lock(mutex_);
  return stall_;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values.at(std::max<std::size_t>(rank, 1) - 1);
}

}  // namespace fairway::hostile
