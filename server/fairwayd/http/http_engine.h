#pragma once

#include <string>
#include <vector>

#include "server/fairwayd/http/connection.h"
#include "server/fairwayd/http/http_message.h"
#include "server/fairwayd/telemetry/log.h"

namespace fairway {

/// What answers requests. Called from many threads at once.
class HttpApplication {
 public:
  virtual ~HttpApplication() = default;

  /// True where the body will be wanted; only of POST, PUT and PATCH.
  virtual bool wants_body(const HttpRequest& request) const = 0;

  /// The answer to a request; `body` is empty unless wants_body(). A body that is not read to its
  /// end ends the connection.
  virtual HttpResponse answer(const HttpRequest& request, BodySource& body) = 0;

  /// True for what has to be answered even where the server is full: short, without a body.
  virtual bool is_vital(std::string_view /*method*/, std::string_view /*path*/) const {
    return false;
  }

  /// Hears of every answer after it was sent.
  virtual void answered(const HttpExchange& /*exchange*/) {}
  /// Hears of connections: +1 where one begins, -1 where it ends.
  virtual void connections_changed(int /*by*/) {}
};

inline constexpr std::size_t kMaxRequestsPerConnection = 1000;

/// Answers all requests of one connection, until it ends or so many are answered.
void serve_connection(Connection& connection, HttpApplication& application, const Log& log,
                      const ConnectionLimits& limits,
                      std::size_t most_requests = kMaxRequestsPerConnection);

}  // namespace fairway
