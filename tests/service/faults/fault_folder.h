#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/places.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::test {

/// What goes wrong around a fairwayd that is started with environment(): see fault_injector.cpp.
class FaultFolder {
 public:
  std::vector<std::string> environment() const {
    return {"LD_PRELOAD=" + preloaded("fault_injector"),
            "FAIRWAY_FAULTS=" + folder_.path().string()};
  }
  /// The wall clock is ahead by so many seconds from now on; monotonic clocks are not.
  void set_clock(long seconds) const {
    const auto next = folder_.path() / "clock.next";
    std::ofstream(next) << seconds;
    std::filesystem::rename(next, folder_.path() / "clock");
  }
  /// Whether processes can be started.
  void allow_processes(bool allowed) const {
    if (allowed) {
      std::filesystem::remove(folder_.path() / "spawn");
    } else {
      std::ofstream(folder_.path() / "spawn") << "no";
    }
  }

 private:
  TemporaryDirectory folder_;
};

}  // namespace fairway::test
