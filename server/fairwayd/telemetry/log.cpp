#include "server/fairwayd/telemetry/log.h"

#include <span>
#include <string>

#include "proto/messages/job_document.h"
#include "server/fairwayd/telemetry/clocks.h"
#include "server/os/file.h"

namespace fairway {
namespace {

constexpr std::size_t kMaxText = 500;

std::string_view name_of(LogLevel level) {
  switch (level) {
    case LogLevel::info:
      return "info";
    case LogLevel::warning:
      return "warning";
    case LogLevel::error:
      return "error";
  }
  return "error";
}

Json cut(const Json& value) {
  const auto* text = value.get_ptr<const Json::string_t*>();
  if (text == nullptr || text->size() <= kMaxText) return value;
  return text->substr(0, kMaxText) + "…";
}

}  // namespace

Log Log::with(std::initializer_list<Field> fields) const {
  Log log = *this;
  for (const auto& [name, value] : fields) log.context_[std::string(name)] = cut(value);
  return log;
}

void Log::write(LogLevel level, std::string_view event, std::initializer_list<Field> fields) const {
  Json line{{"time", rfc3339_utc(wall_clock())}, {"level", name_of(level)}, {"event", event}};
  line.update(context_);
  for (const auto& [name, value] : fields) line[std::string(name)] = cut(value);
  const std::string text = dump_json(line) + "\n";
  // One write per line keeps lines whole. A log that cannot be written has nowhere to complain.
  [[maybe_unused]] const auto done =
      write_all(descriptor_, std::as_bytes(std::span(text.data(), text.size())));
}

}  // namespace fairway
