// Strict reading of the members of an untrusted JSON document.

#include "proto/formats/json_fields.h"

#include <cmath>

#include <fmt/format.h>

namespace fairway {

Error JsonPlace::error(std::string_view reason) const {
  // Where the reason names no remedy of its own, there is one that always helps.
  const bool has_remedy = reason.find(';') != std::string_view::npos;
  return {ErrorCode::invalid_mesh,
          fmt::format("The glTF is invalid at {}: {}{}", pointer_.empty() ? "its root" : pointer_,
                      reason.ends_with('.') ? reason.substr(0, reason.size() - 1) : reason,
                      has_remedy ? "." : "; export it again, a glTF validator shows the place."),
          pointer_};
}

Error JsonPlace::error_at(std::string_view key, std::string_view reason) const {
  return JsonPlace(*json_, child_pointer(pointer_, key)).error(reason);
}

std::optional<JsonPlace> JsonPlace::find(std::string_view key) const {
  if (!json_->is_object()) return std::nullopt;
  const auto it = json_->find(std::string(key));
  if (it == json_->end()) return std::nullopt;
  return JsonPlace(*it, child_pointer(pointer_, key));
}

bool JsonPlace::has(std::string_view key) const {
  return find(key).has_value();
}

JsonPlace JsonPlace::operator[](std::size_t index) const {
  return {(*json_)[index], fmt::format("{}/{}", pointer_, index)};
}

Result<std::optional<JsonPlace>> JsonPlace::object(std::string_view key) const {
  const auto member = find(key);
  if (member && !member->json().is_object()) return member->error("this must be an object.");
  return member;
}

Result<std::optional<JsonPlace>> JsonPlace::array(std::string_view key) const {
  const auto member = find(key);
  if (member && !member->json().is_array()) return member->error("this must be an array.");
  return member;
}

Result<std::uint64_t> JsonPlace::as_count() const {
  // A JSON integer may be written as 3.0.
  if (json_->is_number_float()) {
    const auto value = json_->get<double>();
    if (value >= 0.0 && value <= static_cast<double>(kMaxCount) && std::trunc(value) == value) {
      return static_cast<std::uint64_t>(value);
    }
  } else if (json_->is_number_unsigned()) {
    const auto value = json_->get<std::uint64_t>();
    if (value <= kMaxCount) return value;
  } else if (json_->is_number_integer()) {
    const auto value = json_->get<std::int64_t>();
    if (value >= 0) return static_cast<std::uint64_t>(value);
  }
  return error("this must be a whole number that is not negative.");
}

Result<std::optional<std::uint64_t>> JsonPlace::count(std::string_view key) const {
  const auto member = find(key);
  if (!member) return std::optional<std::uint64_t>();
  const auto value = member->as_count();
  if (!value) return value.error();
  return std::optional<std::uint64_t>(*value);
}

Result<std::uint64_t> JsonPlace::count_or(std::string_view key, std::uint64_t fallback) const {
  const auto value = count(key);
  if (!value) return value.error();
  return value->value_or(fallback);
}

Result<std::uint64_t> JsonPlace::required_count(std::string_view key) const {
  const auto value = count(key);
  if (!value) return value.error();
  if (!*value) return error(fmt::format("\"{}\" is missing.", key));
  return **value;
}

Result<std::optional<std::size_t>> JsonPlace::index(std::string_view key, std::size_t limit) const {
  const auto value = count(key);
  if (!value) return value.error();
  if (!*value) return std::optional<std::size_t>();
  if (**value >= limit) {
    return error_at(key, fmt::format("index {} of a list of {}.", **value, limit));
  }
  return std::optional<std::size_t>(static_cast<std::size_t>(**value));
}

Result<std::size_t> JsonPlace::required_index(std::string_view key, std::size_t limit) const {
  const auto value = index(key, limit);
  if (!value) return value.error();
  if (!*value) return error(fmt::format("\"{}\" is missing.", key));
  return **value;
}

Result<bool> JsonPlace::flag(std::string_view key) const {
  const auto member = find(key);
  if (!member) return false;
  if (!member->json().is_boolean()) return member->error("this must be true or false.");
  return member->json().get<bool>();
}

Result<std::string_view> JsonPlace::text(std::string_view key) const {
  const auto member = find(key);
  if (!member) return std::string_view();
  if (!member->json().is_string()) return member->error("this must be a string.");
  return std::string_view(member->json().get_ref<const std::string&>());
}

Json& array_of(Json& object, const char* key) {
  Json& member = object[key];
  if (!member.is_array()) member = Json::array();
  return member;
}

}  // namespace fairway
