#include "tests/service/support/event_text.h"

#include <charconv>
#include <utility>

#include <catch2/catch.hpp>

namespace fairway::test {

std::vector<Event> events_of(std::string_view content) {
  std::vector<Event> events;
  Event event;
  for (std::size_t end; (end = content.find('\n')) != std::string_view::npos;) {
    const std::string line(content.substr(0, end));
    content.remove_prefix(end + 1);
    if (line.starts_with("event: ")) event.name = line.substr(7);
    if (line.starts_with("id: ")) event.id = line.substr(4);
    if (line.starts_with("data: ")) event.data = Json::parse(line.substr(6));
    if (line.empty() && !event.name.empty()) events.push_back(std::exchange(event, {}));
  }
  return events;
}

std::string without_chunks(std::string_view body) {
  std::string content;
  while (true) {
    std::size_t size = 0;
    const auto end = std::from_chars(body.data(), body.data() + body.size(), size, 16).ptr;
    body.remove_prefix(static_cast<std::size_t>(end - body.data()));
    REQUIRE(body.starts_with("\r\n"));
    if (size == 0) return content;
    content += body.substr(2, size);
    body.remove_prefix(2 + size + 2);
  }
}

}  // namespace fairway::test
