#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/fairway-submit/http_session.h"
#include "server/fairway-submit/progress.h"

namespace fairway {

/// How a request ended that was tried again where that was worth it.
enum class Ending {
  answered,   ///< for good or ill; also where the caller's receiver refused
  gave_up,    ///< the server lives, and did not take it within the limit
  no_server,  ///< there was none within the limit
  stopped,    ///< the batch ends
};

struct Exchange {
  Ending ending = Ending::answered;
  HttpAnswer answer;  ///< the last one
};

struct ClientSettings {
  HttpSettings http;
  std::chrono::seconds retry_for{300};  ///< one request without success
  std::vector<std::string> labels;
};

/// The API of fairwayd as a batch needs it, with patience. One thread uses it; interrupt() may be
/// called from any.
class ServerClient {
 public:
  /// References must outlive it. `stop` ends pauses; requests under way need interrupt().
  ServerClient(const ClientSettings& settings, ProgressDisplay& progress, std::stop_token stop,
               std::uint64_t seed);

  /// POST /v1/jobs.
  Exchange submit(const Payload& payload, const std::string& idempotency_key);
  /// GET of a job that waits for another version than `etag`; empty: answers at once.
  Exchange job(const std::string& id, const std::string& etag);
  /// GET of a result. `begin` is called before each try, `receive` takes the bytes, `check` says
  /// after a 200 what is wrong with them, or "".
  Exchange result(const std::string& id, const std::function<bool()>& begin,
                  const HttpSession::Receiver& receive,
                  const std::function<std::string(const HttpAnswer&)>& check);

  void interrupt() { session_.stop(); }

 private:
  Exchange persist(const std::function<HttpAnswer()>& request);
  bool pause(std::chrono::milliseconds time);

  HttpSession session_;
  const ClientSettings& settings_;
  ProgressDisplay& progress_;
  const std::stop_token stop_;
  const std::uint64_t seed_;
};

}  // namespace fairway
