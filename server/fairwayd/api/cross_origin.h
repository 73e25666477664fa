#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "server/fairwayd/api/routes.h"
#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// What pages of other sites may do with the service in a visitor's browser (Fetch Standard, CORS).
class CrossOrigin {
 public:
  /// `origins`: those that may read answers and send requests, "https://app.example"; "*" is all.
  explicit CrossOrigin(std::vector<std::string> origins) : origins_(std::move(origins)) {}

  /// A page of a site that is not on the list may not change anything, although browsers would send
  /// its forms. Errors: forbidden.
  Result<void> check(const HttpRequest& request) const;

  /// The answer to OPTIONS at a place: its methods, and for a preflight what the origin may send.
  HttpResponse options(const HttpRequest& request, Place place) const;

  /// Adds what lets a page of an origin on the list read the answer.
  void mark(const HttpRequest& request, HttpResponse& response) const;

 private:
  bool allows(std::string_view origin) const;

  const std::vector<std::string> origins_;
};

/// Splits "https://a.example,https://b.example:8443" or "*". Errors: usage.
Result<std::vector<std::string>> parse_origins(std::string_view text);

}  // namespace fairway
