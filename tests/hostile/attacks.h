#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tests/hostile/score.h"
#include "tests/hostile/target.h"
#include "tests/hostile/wire.h"

namespace fairway::hostile {

inline constexpr std::size_t kBodyLimit = std::size_t{16} << 20;
inline constexpr std::chrono::milliseconds kPatience{60000};

/// The service that one attack is made on, and what it was seen to do.
class Field {
 public:
  Field(Score& score, double patience);

  Target& target() { return target_; }
  std::uint16_t port() const { return target_.port(); }
  double patience() const { return patience_; }
  LivenessProbe& probe() { return probe_; }
  /// A figure for the table.
  void tell(const std::string& figure) { score_.note(figure); }

  /// The server lives, its memory stayed within 256 MiB + 2 × the body limit, /livez was answered
  /// within a second all the while.
  void expect_unharmed();
  /// The connection ends within the patience, with one of these statuses ("413|400") first.
  void expect_refused(Wire& wire, const std::string& statuses) const;
  /// Sends one request, with what comes after its head, and expects its refusal.
  void expect_refused(const std::string& head, const std::string& rest,
                      const std::string& statuses) const;
  /// A small mesh is taken and done by a worker: the service serves others.
  void expect_serving();
  /// The path of a result of about 5 MB.
  std::string large_result();

 private:
  Score& score_;
  const double patience_;
  int jobs_ = 0;
  Target target_;
  LivenessProbe probe_;
};

struct Attack {
  std::string_view name;
  std::string_view what;
  void (*run)(Field& field);
};

/// Attacks on one connection's framing and forms, and of crowds.
std::span<const Attack> framing_attacks();
std::span<const Attack> form_attacks();
std::span<const Attack> crowd_attacks();

/// All of them.
std::vector<Attack> attacks();

void run_attack(Score& score, const Attack& attack, double patience);

/// "POST /v1/jobs" of a GLB with these further header lines.
std::string upload_head(const std::vector<std::string>& lines);

}  // namespace fairway::hostile
