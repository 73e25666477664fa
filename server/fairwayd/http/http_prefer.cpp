#include "server/fairwayd/http/http_prefer.h"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

constexpr std::uint64_t kLongestWait = 86400;

/// The first of each name counts, even where its value is of no use.
struct Met {
  bool respond_async = false;
  bool wait = false;
};

void take(const NamedWord& word, Met& met, Preferences& preferences) {
  if (word.name == "respond-async" && !met.respond_async) {
    met.respond_async = true;
    // "An empty or zero-length value is equivalent to no value"; another value has no meaning.
    preferences.respond_async = word.value.empty();
  } else if (word.name == "wait" && !met.wait) {
    met.wait = true;
    if (const auto seconds = digits_value(word.value)) {
      preferences.wait = std::chrono::seconds(std::min(*seconds, kLongestWait));
    }
  }
}

}  // namespace

Preferences preferences_of(const HttpRequest& request) {
  Preferences preferences;
  Met met;
  for (const auto& [name, value] : request.headers) {
    if (name != "prefer") continue;
    for (const std::string_view element : split_field(value, ',')) {
      if (element.starts_with(';')) continue;
      // What follows a preference are its parameters, of which we know none.
      const auto word = named_word(split_field(element, ';').front());
      if (word) take(*word, met, preferences);
    }
  }
  return preferences;
}

std::string applied_text(const Preferences& applied) {
  std::string text = applied.respond_async ? "respond-async" : "";
  if (applied.wait) {
    text += fmt::format("{}wait={}", text.empty() ? "" : ", ", applied.wait->count());
  }
  return text;
}

}  // namespace fairway
