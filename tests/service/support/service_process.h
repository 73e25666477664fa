#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "server/os/child_process.h"
#include "tests/service/support/http_client.h"

namespace fairway::test {

/// The real fairwayd with the real worker, on a free port of the loopback or where options say.
class ServiceProcess {
 public:
  /// Starts it over a data directory and waits until it listens. `log`: the file that its log is
  /// appended to, else $FAIRWAY_TEST_LOG, else none.
  explicit ServiceProcess(const std::filesystem::path& data,
                          const std::vector<std::string>& options = {},
                          const std::filesystem::path& log = {},
                          const std::vector<std::string>& environment = {});

  std::uint16_t port() const { return port_; }
  /// Of the listener for administration; 0 where there is none.
  std::uint16_t admin_port() const { return admin_port_; }
  HttpClient client() const { return HttpClient(port_); }
  pid_t pid() const { return process_->pid(); }

  /// SIGKILL, as a power cut would.
  void kill();
  /// Sends a signal.
  void signal(int number) { process_->kill(number); }
  /// Waits for its end.
  ExitStatus wait() { return process_->wait(); }
  /// SIGTERM, and the exit status.
  ExitStatus stop();

  /// How many descriptors it has open.
  std::size_t descriptors() const;
  /// Process ids of the workers that run now.
  std::vector<pid_t> workers() const;

 private:
  std::optional<ChildProcess> process_;
  std::uint16_t port_ = 0;
  std::uint16_t admin_port_ = 0;
};

/// Starts fairwayd with arguments that it refuses; its exit status and what it said.
struct Refusal {
  ExitStatus status;
  std::string text;
};
Refusal refused_start(const std::vector<std::string>& arguments);

}  // namespace fairway::test
