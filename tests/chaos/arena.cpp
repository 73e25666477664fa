#include "tests/chaos/arena.h"

#include <csignal>
#include <system_error>
#include <thread>

#include <fmt/format.h>
#include <sys/wait.h>

#include "tests/chaos/watchdog.h"
#include "tests/service/support/job_follower.h"

namespace fairway::chaos {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr double kStartBound = 2000.0;
constexpr milliseconds kTidyWithin{5000};
constexpr milliseconds kDieWithin{30000};
constexpr std::size_t kLongestList = 200;

/// "out-" + id + "-" + fence.

std::string result_owner(const fs::path& blob) {
  const std::string name = blob.filename();
  if (!name.starts_with("out-")) return {};
  const std::size_t fence = name.find('-', std::string_view("out-").size());
  const std::size_t id = fence == std::string::npos ? fence : name.find('-', fence + 1);
  return id == std::string::npos ? std::string() : name.substr(id + 1);
}

}  // namespace

std::string path_of(const std::string& id) {
  return "/v1/jobs/" + id;
}

void Arena::start(const std::vector<std::string>& environment) {
  std::vector<std::string> options = {"--min-free", "0"};
  options.insert(options.end(), options_.begin(), options_.end());
  started_ = steady_clock::now();
  service_.emplace(directory(), options, fs::path(), environment);
  watch_service(service_->pid());
  expect(client().get("/livez").status == 200, "a started service does not answer /livez");
  trials_.measure("start until /livez answers", milliseconds_up(), "ms", kStartBound);
}

void Arena::kill() {
  watch_service(0);
  if (service_) service_->kill();
  service_.reset();
}

bool Arena::wait_for_death() {
  const auto until = steady_clock::now() + kDieWithin;
  while (steady_clock::now() < until) {
    if (is_dead()) return true;
    std::this_thread::sleep_for(milliseconds(2));
  }
  return false;
}

bool Arena::is_dead() const {
  siginfo_t ended{};
  ::waitid(P_PID, static_cast<id_t>(service_->pid()), &ended, WEXITED | WNOHANG | WNOWAIT);
  return ended.si_pid != 0 && ended.si_code == CLD_KILLED && ended.si_status == SIGKILL;
}

std::string Arena::submit(const Work& work) {
  const std::string path = test::submit(client(), work.mesh, work.parameters);
  std::string id = path.substr(path_of("").size());
  promise(id, work.sha256);
  return id;
}

Json Arena::job(const std::string& id) const {
  const test::Answer answer = client().get(path_of(id));
  expect(answer.status == 200, fmt::format("job {} is lost: {}", id, answer.status));
  return answer.json();
}

void Arena::wait_until_claimed(const std::string& id) const {
  test::follow(client(), path_of(id), [](const Json& job) { return job["state"] != "queued"; });
}

double Arena::until_running_again(const std::string& id) const {
  test::follow(client(), path_of(id), [](const Json& job) {
    if (job["state"] == "running") return job.contains("progress");
    return job["state"] != "queued";
  });
  return milliseconds_up();
}

void Arena::expect_kept(const std::string& id, const std::string& sha256) const {
  job(id);  // lost where it is not there
  const Json job = test::wait_until_final(client(), path_of(id));
  expect(job["state"] == "succeeded", fmt::format("job {} ended otherwise: {}", id, job.dump()));
  const std::string stated = job["result"]["sha256"];
  const test::Answer result = client().get(path_of(id) + "/result");
  expect(result.status == 200, fmt::format("job {} has no result: {}", id, result.status));
  expect(sha256_of(result.body) == stated, fmt::format("the result of job {} is torn", id));
  expect(stated == sha256,
         fmt::format("the result of job {} is {}, undisturbed {}", id, stated, sha256));
}

void Arena::expect_promises_kept() {
  expect_results();
  expect_clean_disk();
}

void Arena::expect_results() {
  for (const auto& [id, sha256] : open_) {
    expect_kept(id, sha256);
    kept_.insert(id);
  }
  open_.clear();
}

void Arena::expect_no_strangers() const {
  const Json jobs = client().get("/v1/jobs?limit=200").json()["jobs"];
  for (const Json& job : jobs) {
    const std::string id = job["id"];
    expect(kept_.contains(id) || open_.contains(id),
           fmt::format("job {} was never accepted: {}", id, job.dump()));
  }
}

/// What should not be there, or is missing; empty where all is well.
std::string Arena::leftovers() const {
  std::string found;
  for (const auto& entry : fs::directory_iterator(directory() / "spool")) {
    found += " spool/" + entry.path().filename().string();
  }
  std::set<std::string> owners;
  std::size_t inputs = 0;
  for (const auto& entry : fs::directory_iterator(directory() / "blobs")) {
    if (entry.path().filename().string().starts_with("in-")) {
      ++inputs;
      continue;
    }
    const std::string owner = result_owner(entry.path());
    const bool first = owners.insert(owner).second;
    if (!kept_.contains(owner) || !first) found += " blobs/" + entry.path().filename().string();
  }
  for (const std::string& id : kept_) {
    if (!owners.contains(id)) found += " no result of " + id;
  }
  // Every job keeps its input until it expires.
  if (inputs != kept_.size()) found += fmt::format(" {} inputs of {} jobs", inputs, kept_.size());
  return found;
}

void Arena::expect_clean_disk() const {
  // A late result goes after its refusal.
  const auto until = steady_clock::now() + kTidyWithin;
  std::string found = leftovers();
  while (!found.empty() && steady_clock::now() < until) {
    std::this_thread::sleep_for(milliseconds(2));
    found = leftovers();
  }
  expect(found.empty(), "the data directory is not clean:" + found.substr(0, kLongestList));
}

bool Arena::has_result(const std::string& id) const {
  for (const auto& entry : fs::directory_iterator(directory() / "blobs")) {
    if (result_owner(entry.path()) == id) return true;
  }
  return false;
}

std::uintmax_t Arena::spooled_bytes() const {
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::directory_iterator(directory() / "spool")) {
    std::error_code gone;
    const auto size = fs::file_size(entry.path(), gone);
    if (!gone) bytes += size;
  }
  return bytes;
}

void run_in_arena(Trials& trials, const std::vector<std::string>& options, std::size_t count,
                  const std::function<void(Arena& arena, std::size_t i)>& trial) {
  std::optional<Arena> arena;
  for (std::size_t i = 0; i < count; ++i) {
    const bool whole = trials.run(fmt::format("#{}", i), [&] {
      if (!arena) arena.emplace(trials, options).start();
      trial(*arena, i);
    });
    if (!whole) arena.reset();
  }
}

}  // namespace fairway::chaos
