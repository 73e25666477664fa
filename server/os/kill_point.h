#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fairway {

/// A testing hook: places on the way of a job where a process can be told to die, or to freeze.
/// FAIRWAY_KILL_AT=NAME[:N] sends the process SIGKILL when it passes NAME for the N-th (first)
/// time, FAIRWAY_STOP_AT=NAME[:N] sends it SIGSTOP. A point of the worker is meant for the N-th
/// worker that a service starts. Other names do nothing. Without these variables a point costs the
/// test of a bool. `./dev chaos` goes through the table.

/// Which program passes a point.
enum class Passer { service, worker };

struct KillPoint {
  std::string_view name;
  Passer passer = Passer::service;
  int passes = 1;  ///< how often one job passes it: with its input, then with its result
};

/// In the order in which a job of one small file meets them. A point stands right before the call
/// that it names; those that end in -ed stand behind it.
inline constexpr std::array kKillPoints = {
    KillPoint{"file.created", Passer::service, 2},
    KillPoint{"spool.write"},
    KillPoint{"file.fsync", Passer::service, 2},
    KillPoint{"file.rename", Passer::service, 2},
    KillPoint{"file.sync_directory", Passer::service, 2},
    KillPoint{"file.synced", Passer::service, 2},
    KillPoint{"submit.commit"},
    KillPoint{"submit.committed"},
    KillPoint{"submit.answer"},
    KillPoint{"claim.commit"},
    KillPoint{"claim.committed"},
    KillPoint{"worker.spawned"},
    KillPoint{"order.received", Passer::worker},
    KillPoint{"output.write", Passer::worker},
    KillPoint{"output.written", Passer::worker},
    KillPoint{"finish.told", Passer::worker},
    KillPoint{"worker.reaped"},
    KillPoint{"result.adopted"},
    KillPoint{"finish.update"},
    KillPoint{"finish.commit"},
    KillPoint{"finish.committed"},
    KillPoint{"result.announced"},
};

inline constexpr std::string_view kKillVariable = "FAIRWAY_KILL_AT";
inline constexpr std::string_view kStopVariable = "FAIRWAY_STOP_AT";

/// Whether a variable of the environment belongs to this hook.
constexpr bool is_kill_variable(std::string_view name) {
  return name == kKillVariable || name == kStopVariable;
}

/// A row of the table, found by the compiler: a name that is not in it does not compile.
struct KillPointRow {
  consteval KillPointRow(const char* name) {
    while (kKillPoints.at(row).name != name) ++row;
  }
  std::size_t row = 0;
};

/// What the environment asks of this process.
class KillOrder {
 public:
  KillOrder() {
    if (!read(kKillVariable, SIGKILL)) read(kStopVariable, SIGSTOP);
  }

  /// The process's own; its environment is read once.
  static KillOrder& of_process() {
    static KillOrder order;
    return order;
  }

  bool armed() const { return row_.has_value(); }

  void pass(std::size_t row) {
    // To this thread: one sent to the process may stop it only after the next call.
    if (row == *row_ && ++passed_ == wanted_) ::raise(signal_);
  }

  /// The environment of the next worker: empty but for the one that is meant.
  std::vector<std::string> for_next_worker() {
    if (!armed() || kKillPoints.at(*row_).passer != Passer::worker) return {};
    if (++workers_ != wanted_) return {};
    const std::string_view variable = signal_ == SIGKILL ? kKillVariable : kStopVariable;
    return {std::string(variable) + "=" + std::string(kKillPoints.at(*row_).name)};
  }

 private:
  bool read(std::string_view variable, int signal) {
    const char* value = std::getenv(variable.data());  // the variables are literals
    if (value == nullptr) return false;
    const std::string_view text = value;
    const std::size_t colon = std::min(text.find(':'), text.size());
    for (std::size_t row = 0; row < kKillPoints.size(); ++row) {
      if (kKillPoints.at(row).name == text.substr(0, colon)) row_ = row;
    }
    if (colon < text.size()) {
      std::from_chars(text.data() + colon + 1, text.data() + text.size(), wanted_);
    }
    signal_ = signal;
    return true;
  }

  std::optional<std::size_t> row_;  ///< none: nothing ever happens
  int wanted_ = 1;
  int signal_ = SIGKILL;
  std::atomic<int> passed_ = 0;
  std::atomic<int> workers_ = 0;
};

/// Dies or freezes here, if that was asked for.
inline void kill_point(KillPointRow point) {
  KillOrder& order = KillOrder::of_process();
  if (order.armed()) [[unlikely]] {
    order.pass(point.row);
  }
}

}  // namespace fairway
