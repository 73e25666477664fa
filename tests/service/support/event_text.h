#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "proto/messages/json.h"

namespace fairway::test {

/// A server-sent event whose data is JSON.
struct Event {
  std::string name;
  std::string id;  ///< "" where it has none
  Json data;
};

/// The events of a stream, in their order; comments are left out.
std::vector<Event> events_of(std::string_view content);

/// The content of a chunked body that came whole; fails the test where it did not.
std::string without_chunks(std::string_view body);

}  // namespace fairway::test
