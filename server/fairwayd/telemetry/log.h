#pragma once

#include <initializer_list>
#include <string_view>
#include <utility>

#include "proto/messages/json.h"

namespace fairway {

enum class LogLevel { info, warning, error };

/// One JSON object a line: time, level, event, then the fields. Text is escaped and cut, so that
/// nothing a client or a library says can forge a line. Any thread may write.
class Log {
 public:
  using Field = std::pair<std::string_view, Json>;

  /// Writes to a descriptor that stays open and is not owned.
  explicit Log(int descriptor) : descriptor_(descriptor) {}

  /// The same log with fields that every line of it begins with.
  Log with(std::initializer_list<Field> fields) const;

  /// `event` is a fixed snake_case word.
  void write(LogLevel level, std::string_view event,
             std::initializer_list<Field> fields = {}) const;

 private:
  int descriptor_;
  Json context_ = Json::object();
};

}  // namespace fairway
