#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/chaos/trials.h"
#include "tests/chaos/work.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::chaos {

/// The path of a job in the API.
std::string path_of(const std::string& id);

/// One data directory, the service over it, and all that it has promised. Every member throws
/// Broken where a promise does not hold; then another arena is needed.
class Arena {
 public:
  explicit Arena(Trials& trials, std::vector<std::string> options = {})
      : trials_(trials), options_(std::move(options)) {}
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  ~Arena() { kill(); }

  /// Starts the service; until /livez answers, at most two seconds may pass.
  void start(const std::vector<std::string>& environment = {});
  /// SIGKILL, where it runs.
  void kill();
  /// Waits for the end that the service makes by itself. False: it lives on, for 30 s.
  bool wait_for_death();
  /// Whether it has been killed, without waiting.
  bool is_dead() const;

  test::ServiceProcess& service() { return *service_; }
  test::HttpClient client() const { return service_->client(); }
  const std::filesystem::path& directory() const { return directory_.path(); }
  /// Milliseconds since the last start() began.
  double milliseconds_up() const { return milliseconds_since(started_); }

  /// POSTs a job, which must be accepted. Returns its id.
  std::string submit(const Work& work);
  /// The service has answered 202 for this id.
  void promise(const std::string& id, const std::string& sha256) { open_[id] = sha256; }
  /// The same, where the caller has seen to it that the promise was kept.
  void note_kept(const std::string& id) { kept_.insert(id); }
  /// Follows every job that was promised and not yet kept to its end: it succeeded, and its result
  /// is the undisturbed one.
  void expect_results();
  /// expect_results() and expect_clean_disk().
  void expect_promises_kept();
  /// There is no job but the promised ones.
  void expect_no_strangers() const;
  /// The spool is empty, and each job that was kept has one result.
  void expect_clean_disk() const;

  /// The job's document.
  Json job(const std::string& id) const;
  /// Waits until the job has left the queue.
  void wait_until_claimed(const std::string& id) const;
  /// Milliseconds from the last start() until the job was seen over, or at work under this very
  /// server: what a dead one left as running has no progress.
  double until_running_again(const std::string& id) const;
  /// Whether a result of this job lies in the directory.
  bool has_result(const std::string& id) const;
  /// Bytes of unfinished files.
  std::uintmax_t spooled_bytes() const;

 private:
  void expect_kept(const std::string& id, const std::string& sha256) const;
  std::string leftovers() const;

  Trials& trials_;
  const std::vector<std::string> options_;
  const test::TemporaryDirectory directory_;
  std::optional<test::ServiceProcess> service_;
  std::chrono::steady_clock::time_point started_;
  std::map<std::string, std::string> open_;  ///< id, and the digest of the result to come
  std::set<std::string> kept_;
};

/// Runs trials in one arena, whose service runs; after a broken one in a new one.
void run_in_arena(Trials& trials, const std::vector<std::string>& options, std::size_t count,
                  const std::function<void(Arena& arena, std::size_t i)>& trial);

}  // namespace fairway::chaos
