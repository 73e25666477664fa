#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "core/result.h"
#include "server/fairway-submit/payload.h"
#include "server/fairway-submit/server_address.h"

namespace fairway {

/// What came of a request.
struct HttpAnswer {
  /// Why no answer came.
  enum class Lost {
    nothing,      ///< one came
    connection,   ///< not made, or broken
    distrust,     ///< the server's certificate is not trusted: it will not be
    by_receiver,  ///< the caller's receiver, or reading the payload, refused to go on
  };

  int status = 0;  ///< 0: none came
  Lost lost = Lost::nothing;
  std::string reason = {};                          ///< where it is lost, a phrase
  std::map<std::string, std::string> headers = {};  ///< names in lower case
  std::string body = {};                            ///< of what no receiver took

  std::string header(const std::string& lower_name) const;
};

/// How a session talks.
struct HttpSettings {
  ServerAddress server;
  std::string api_key;         ///< empty: none
  std::string ca_certificate;  ///< PEM file; empty: those of the system
};

/// One connection to the server at a time, kept alive between requests. One thread uses it; stop()
/// may be called from any.
class HttpSession {
 public:
  explicit HttpSession(const HttpSettings& settings);
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;
  ~HttpSession();

  using Headers = std::multimap<std::string, std::string>;
  /// Takes a piece of the body of a 200. False: go no further.
  using Receiver = std::function<bool(std::string_view)>;

  /// `path` is percent-encoded and begins with "/v1". Without a receiver the body is in the answer.
  HttpAnswer get(const std::string& path, const Headers& headers, const Receiver& receiver = {});
  HttpAnswer post(const std::string& path, const Headers& headers, const Payload& payload);

  /// Breaks off the request under way, if any.
  void stop();

 private:
  class Client;
  std::unique_ptr<Client> client_;
};

}  // namespace fairway
