#include "server/fairwayd/http/http_accept.h"

#include <optional>
#include <span>
#include <string>

#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

/// "0.25" as 250.
int weight_of(std::string_view value) {
  constexpr std::size_t kMostDigits = 3;
  if (!value.starts_with("0")) return kFullWeight;
  std::string digits(value.substr(1));
  if (digits.starts_with('.')) digits.erase(0, 1);
  if (digits.size() > kMostDigits) return kFullWeight;
  digits.resize(kMostDigits, '0');
  const auto number = digits_value(digits);
  return number ? static_cast<int>(*number) : kFullWeight;
}

struct MediaRange {
  int precision = 0;  ///< 1: any type, 2: any of a type, 3: exactly this one
  int weight = kFullWeight;
};

/// What an element of Accept says about a type; nothing where it does not fit.
std::optional<MediaRange> range_for(std::string_view element, std::string_view media_type) {
  const auto parts = split_field(element, ';');
  if (parts.empty()) return std::nullopt;
  const std::string range = lower_case(parts.front());
  MediaRange fit;
  if (range == "*/*") {
    fit.precision = 1;
  } else if (range.ends_with("/*") &&
             media_type.starts_with(std::string_view(range).substr(0, range.size() - 1))) {
    fit.precision = 2;
  } else if (range == media_type) {
    fit.precision = 3;
  } else {
    return std::nullopt;
  }
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const auto parameter = named_word(parts[i]);
    if (!parameter || parameter->name != "q") return std::nullopt;
    fit.weight = weight_of(parameter->value);
  }
  return fit;
}

}  // namespace

int accept_weight(const HttpRequest& request, std::string_view media_type) {
  bool any_range = false;
  MediaRange best;
  for (const auto& [name, value] : request.headers) {
    if (name != "accept") continue;
    for (const std::string_view element : split_field(value, ',')) {
      any_range = true;
      const auto fit = range_for(element, media_type);
      if (fit && fit->precision > best.precision) best = *fit;
    }
  }
  if (!any_range) return kFullWeight;
  return best.precision > 0 ? best.weight : 0;
}

bool takes_coding(const HttpRequest& request, std::string_view coding) {
  std::optional<int> any;
  for (const auto& [name, value] : request.headers) {
    if (name != "accept-encoding") continue;
    for (const std::string_view element : split_field(value, ',')) {
      const auto parts = split_field(element, ';');
      if (parts.empty()) continue;
      int weight = kFullWeight;
      for (const std::string_view part : std::span(parts).subspan(1)) {
        const auto parameter = named_word(part);
        if (parameter && parameter->name == "q") weight = weight_of(parameter->value);
      }
      if (same_word(parts.front(), coding)) return weight > 0;
      if (parts.front() == "*") any = weight;
    }
  }
  return any.value_or(0) > 0;
}

}  // namespace fairway
