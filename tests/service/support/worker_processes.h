#pragma once

#include <string_view>
#include <vector>

#include <sys/types.h>

namespace fairway::test {

/// How workers call themselves.
inline constexpr std::string_view kWorkingWorker = "fairway-job";
inline constexpr std::string_view kWaitingWorker = "fairway-idle";

/// Process ids of the children of a process that call themselves so.
std::vector<pid_t> children_called(std::string_view name, pid_t parent);

}  // namespace fairway::test
