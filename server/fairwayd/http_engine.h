#pragma once

#include <string>
#include <vector>

#include "server/fairwayd/connection.h"
#include "server/fairwayd/http_message.h"
#include "server/fairwayd/log.h"

namespace fairway {

/// What answers requests. Called from many threads at once.
class HttpApplication {
 public:
  virtual ~HttpApplication() = default;

  /// Regular expressions (ECMAScript) of the paths to which a body may be sent by POST.
  virtual std::vector<std::string> upload_paths() const = 0;

  /// True where `body` will be wanted: a POST to one of upload_paths().
  virtual bool is_upload(const HttpRequest& request) const = 0;

  /// The answer to a request; `body` is empty unless is_upload(). A body that is not read to its
  /// end ends the connection.
  virtual HttpResponse answer(const HttpRequest& request, BodySource& body) = 0;
};

/// Answers all requests of one connection, until it ends.
void serve_connection(Connection& connection, HttpApplication& application, const Log& log,
                      const ConnectionLimits& limits);

}  // namespace fairway
