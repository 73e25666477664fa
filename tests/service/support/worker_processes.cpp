#include "tests/service/support/worker_processes.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>

namespace fairway::test {

std::vector<pid_t> children_called(std::string_view name, pid_t parent) {
  std::vector<pid_t> found;
  const auto tasks = fmt::format("/proc/{}/task", parent);
  for (const auto& task : std::filesystem::directory_iterator(tasks)) {
    std::ifstream children(task.path() / "children");
    for (pid_t child; children >> child;) {
      std::string called;
      std::ifstream(fmt::format("/proc/{}/comm", child)) >> called;
      if (called == name) found.push_back(child);
    }
  }
  return found;
}

}  // namespace fairway::test
