#include "tests/hostile/access_trace.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/os/child_process.h"
#include "server/os/file.h"
#include "tests/places.h"

namespace fairway::hostile {
namespace {

constexpr const char* kTracer = "/usr/bin/strace";

/// "1234 openat(AT_FDCWD, "/etc/passwd", O_RDONLY) = 3" as "openat /etc/passwd". Empty for what
/// speaks over a descriptor that the worker was given, and for what is no call.
std::string access_in(std::string_view line) {
  constexpr std::array<std::string_view, 9> kOverGiven = {
      "sendto",     "recvfrom",   "sendmsg",     "recvmsg",    "shutdown",
      "getsockopt", "setsockopt", "getsockname", "getpeername"};
  const std::size_t name_at = std::min(line.find_first_not_of("0123456789 "), line.size());
  line.remove_prefix(name_at);
  const std::size_t open = line.find('(');
  if (open == std::string_view::npos || line.starts_with("+++") || line.starts_with("---") ||
      line.starts_with("<...")) {
    return {};
  }
  const std::string name(line.substr(0, open));
  if (std::find(kOverGiven.begin(), kOverGiven.end(), name) != kOverGiven.end()) return {};
  const std::size_t first = line.find('"');
  if (first == std::string_view::npos) return name + " without a path";
  return name + " " + std::string(line.substr(first + 1, line.find('"', first + 1) - first - 1));
}

int run_quietly(const std::vector<std::string>& arguments) {
  const auto null = open_file("/dev/null", O_RDWR);
  if (!null) return -1;
  auto process =
      ChildProcess::spawn({kTracer, arguments, {}, {null->get(), null->get(), null->get()}});
  if (!process) return -1;
  return process->wait().code;
}

}  // namespace

bool AccessTrace::is_possible() {
  return ::access(kTracer, X_OK) == 0 &&
         run_quietly({"-f", "-e", "trace=file", "-o", "/dev/null", "/bin/true"}) == 0;
}

AccessTrace::AccessTrace() {
  std::ofstream(program()) << fmt::format(
      "#!/bin/sh\nexec {} -f -qq -s 200 -e signal=none -e trace=file,network -o {}/trace.$$ {} "
      "\"$@\"\n",
      kTracer, directory_.path().string(), test::program("fairway"));
  ::chmod(program().c_str(), 0700);
}

std::set<std::string> AccessTrace::new_accesses() {
  std::set<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(directory_.path())) {
    if (!entry.path().filename().string().starts_with("trace.")) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    std::size_t& read = read_[entry.path()];
    file.seekg(static_cast<std::streamoff>(read));
    std::string text((std::istreambuf_iterator<char>(file)), {});
    text.resize(text.rfind('\n') + 1);
    read += text.size();
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      if (std::string access = access_in(line); !access.empty()) found.insert(std::move(access));
    }
  }
  return found;
}

}  // namespace fairway::hostile
