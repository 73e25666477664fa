// The lock on a data directory.
#include "server/fairwayd/store/data_directory.h"

#include <csignal>

#include <catch2/catch.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/service/support/temporary_directory.h"

using namespace fairway;

namespace {

/// A process that holds the directory and has a child that has all its files, as a worker that is
/// being spawned does. Ends both.
class Holder {
 public:
  explicit Holder(const std::filesystem::path& path) {
    int ready[2];
    REQUIRE(::pipe(ready) == 0);
    server_ = ::fork();
    if (server_ == 0) hold(path, ready[1]);
    REQUIRE(::read(ready[0], &worker_, sizeof worker_) == sizeof worker_);
    ::close(ready[0]);
    ::close(ready[1]);
  }
  ~Holder() {
    if (server_ > 0) kill_server();
    ::kill(worker_, SIGKILL);
  }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;

  void kill_server() {
    ::kill(server_, SIGKILL);
    ::waitpid(server_, nullptr, 0);
    server_ = 0;
  }
  bool worker_lives() const { return ::kill(worker_, 0) == 0; }

 private:
  [[noreturn]] static void hold(const std::filesystem::path& path, int ready) {
    const auto held = DataDirectory::open(path);
    if (!held) ::_exit(1);
    pid_t worker = ::fork();
    if (worker != 0 && ::write(ready, &worker, sizeof worker) != sizeof worker) ::_exit(1);
    for (;;) ::pause();
  }

  pid_t server_ = 0;
  pid_t worker_ = 0;
};

}  // namespace

TEST_CASE("a data directory is held by one process, and free at once when that is killed") {
  const test::TemporaryDirectory directory;
  Holder holder(directory.path());
  const auto refused = DataDirectory::open(directory.path());
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::conflict);
  holder.kill_server();
  CHECK(DataDirectory::open(directory.path()));
  CHECK(holder.worker_lives());
}
