#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/result.h"
#include "server/os/child_process.h"

namespace fairway::bench {

/// Processor time, seconds, user and system.
struct ProcessorTime {
  double server = 0.0;
  double workers = 0.0;  ///< the server's children that have ended
  double client = 0.0;   ///< this process
  double machine = 0.0;  ///< all that runs on it, and what a hypervisor took away
};

ProcessorTime operator-(const ProcessorTime& later, const ProcessorTime& earlier);

/// A server on a free port of the loopback, while this lives.
class MeasuredProcess {
 public:
  /// Starts it and waits for the line in which it says "… listening on http://HOST:PORT". What else
  /// it says goes to `log`. Errors: unavailable, io.
  static Result<MeasuredProcess> start(const std::filesystem::path& program,
                                       std::vector<std::string> arguments,
                                       const std::filesystem::path& log);
  MeasuredProcess(MeasuredProcess&&) = default;
  MeasuredProcess& operator=(MeasuredProcess&&) = delete;
  ~MeasuredProcess();

  std::uint16_t port() const { return port_; }
  /// Used up to now. To about 10 ms: measure long runs.
  ProcessorTime processor_time() const;
  /// Resident memory, bytes; 0 where it cannot be told.
  std::uint64_t resident_bytes() const;

 private:
  MeasuredProcess(ChildProcess process, std::uint16_t port)
      : process_(std::move(process)), port_(port) {}

  ChildProcess process_;
  std::uint16_t port_;
};

}  // namespace fairway::bench
