#pragma once

#include <string>

#include "server/fairwayd/api/routes.h"
#include "server/fairwayd/http/http_message.h"

namespace fairway {

/// What the service tells programs of itself: the OpenAPI document and the methods. The same bytes
/// for as long as the program runs.
class Contract {
 public:
  Contract();

  /// Of the places methods and openapi; not_found for others.
  HttpResponse answer(Place place) const;

 private:
  const std::string openapi_;
  const std::string methods_;
};

}  // namespace fairway
