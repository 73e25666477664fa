#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "tests/chaos/work.h"
#include "tests/service/support/http_client.h"

namespace fairway::chaos {

inline constexpr std::size_t kClients = 16;

/// What the clients of a crowd were told.
struct Told {
  std::map<std::string, std::string> accepted;  ///< id, and the digest of its result to come
  std::vector<double> refusals;                 ///< milliseconds until a 429
  std::vector<int> others;                      ///< any other status
};

/// Headers of a submit that is done anew although equal work has a result.
inline const test::HttpClient::Headers kWorkOfItsOwn = {{"Cache-Control", "no-cache"}};

/// Works of a crowd, fewer than its jobs.
std::vector<Work> kinds_of(Workshop& workshop);

/// Asks for `jobs` jobs from several threads, each job until it is accepted.
class Crowd {
 public:
  Crowd(const test::HttpClient& client, const std::vector<Work>& kinds, std::size_t jobs)
      : client_(client), kinds_(kinds), jobs_(jobs) {}

  /// Once. All clients send the same headers.
  Told ask(std::size_t clients, const test::HttpClient::Headers& headers);

 private:
  void serve_client(const test::HttpClient::Headers& headers);
  bool offer(const Work& work, const test::HttpClient::Headers& headers);

  const test::HttpClient client_;
  const std::vector<Work>& kinds_;
  const std::size_t jobs_;
  std::atomic<std::size_t> next_ = 0;

  std::mutex mutex_;
  Told told_;  ///< guarded by mutex_
};

/// Throws Broken unless so many jobs were accepted, each with an id of its own.
void expect_accepted(const Told& told, std::size_t jobs);

}  // namespace fairway::chaos
