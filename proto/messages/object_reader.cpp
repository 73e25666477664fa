// Strict reading of one JSON object.

#include "proto/messages/object_reader.h"

#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace fairway {
namespace {

const Json kAbsent;

}  // namespace

ObjectReader::ObjectReader(const Json& json, std::string pointer)
    : json_(&json), pointer_(std::move(pointer)) {}

bool ObjectReader::holds(std::string_view key) const {
  return json_->is_object() && json_->contains(key);
}

bool ObjectReader::holds_object(std::string_view key) const {
  return holds(key) && json_->find(key)->is_object();
}

const Json* ObjectReader::find(std::string_view key) {
  known_.emplace(key);
  return !error_ && holds(key) ? &*json_->find(key) : nullptr;
}

bool ObjectReader::is_auto(std::string_view key) const {
  const Json& json = *json_->find(key);
  return json.is_string() && json.get_ref<const std::string&>() == "auto";
}

void ObjectReader::fail(std::string_view key, std::string_view reason) {
  if (error_) return;
  error_ = Error{ErrorCode::invalid_parameters, fmt::format("\"{}\" {}.", key, reason),
                 child_pointer(pointer_, key)};
}

std::optional<double> ObjectReader::number_in(std::string_view key, const Json& json, Range range,
                                              std::string_view alternative) {
  const double value = json.is_number() ? json.get<double>() : NAN;
  if (value >= range.low && value <= range.high) return value;
  fail(key, fmt::format("must be a number from {} to {}{}", range.low, range.high, alternative));
  return std::nullopt;
}

std::optional<int> ObjectReader::integer_in(std::string_view key, const Json& json, int low,
                                            int high, std::string_view alternative) {
  const double value = json.is_number() ? json.get<double>() : NAN;
  if (value >= low && value <= high && value == std::floor(value)) return static_cast<int>(value);
  fail(key, fmt::format("must be a whole number from {} to {}{}", low, high, alternative));
  return std::nullopt;
}

void ObjectReader::boolean(std::string_view key, bool& target) {
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_boolean()) return fail(key, "must be true or false");
  target = json->get<bool>();
}

void ObjectReader::number(std::string_view key, Range range, double& target) {
  const Json* json = find(key);
  if (json == nullptr) return;
  target = number_in(key, *json, range, "").value_or(target);
}

void ObjectReader::number_or_auto(std::string_view key, Range range,
                                  std::optional<double>& target) {
  const Json* json = find(key);
  if (json == nullptr || is_auto(key)) return;
  target = number_in(key, *json, range, ", or \"auto\"");
}

void ObjectReader::integer(std::string_view key, int low, int high, int& target) {
  const Json* json = find(key);
  if (json == nullptr) return;
  target = integer_in(key, *json, low, high, "").value_or(target);
}

void ObjectReader::integer_or_auto(std::string_view key, int low, int high,
                                   std::optional<int>& target) {
  const Json* json = find(key);
  if (json == nullptr || is_auto(key)) return;
  target = integer_in(key, *json, low, high, ", or \"auto\"");
}

void ObjectReader::integer_or_false(std::string_view key, int low, int high, int& target) {
  const Json* json = find(key);
  if (json == nullptr) return;
  if (json->is_boolean() && !json->get<bool>()) {
    target = 0;
    return;
  }
  target = integer_in(key, *json, low, high, ", or false").value_or(target);
}

void ObjectReader::text(std::string_view key,
                        const std::function<std::string(std::string_view)>& complain,
                        std::string& target) {
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_string()) return fail(key, "must be a string");
  const auto& value = json->get_ref<const std::string&>();
  if (const std::string wrong = complain(value); !wrong.empty()) return fail(key, wrong);
  target = value;
}

void ObjectReader::strings(std::string_view key,
                           const std::function<std::string(std::string_view)>& accept) {
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_array()) return fail(key, "must be a list of names");
  for (std::size_t i = 0; i < json->size() && !error_; ++i) {
    const Json& item = (*json)[i];
    const std::string wrong = item.is_string() ? accept(item.get_ref<const std::string&>())
                                               : std::string("must be a name");
    if (wrong.empty()) continue;
    error_ = Error{ErrorCode::invalid_parameters, fmt::format("\"{}\" item {} {}.", key, i, wrong),
                   fmt::format("{}/{}", child_pointer(pointer_, key), i)};
  }
}

void ObjectReader::indices(std::string_view key, std::size_t most, std::vector<Index>& target) {
  constexpr int kLast = std::numeric_limits<int>::max();
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_array()) return fail(key, "must be a list of indices");
  if (json->size() > most) return fail(key, fmt::format("must have at most {} entries", most));
  target.reserve(json->size());
  for (std::size_t i = 0; i < json->size(); ++i) {
    const double value = (*json)[i].is_number() ? (*json)[i].get<double>() : NAN;
    if (!(value >= 0.0 && value <= kLast && value == std::floor(value))) {
      error_ =
          Error{ErrorCode::invalid_parameters,
                fmt::format("\"{}\" item {} must be a whole number from 0 to {}.", key, i, kLast),
                fmt::format("{}/{}", child_pointer(pointer_, key), i)};
      return;
    }
    target.push_back(static_cast<Index>(value));
  }
}

bool ObjectReader::holds_objects(std::string_view key) const {
  if (!holds(key)) return false;
  const Json& json = *json_->find(key);
  return json.is_array() && !json.empty() && json.front().is_object();
}

void ObjectReader::objects(std::string_view key, const std::function<void(ObjectReader&)>& read) {
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_array()) return fail(key, "must be a list of objects");
  for (std::size_t i = 0; i < json->size() && !error_; ++i) {
    const std::string pointer = fmt::format("{}/{}", child_pointer(pointer_, key), i);
    if (!(*json)[i].is_object()) {
      error_ = Error{ErrorCode::invalid_parameters,
                     fmt::format("\"{}\" item {} must be an object.", key, i), pointer};
      return;
    }
    ObjectReader item((*json)[i], pointer);
    read(item);
    take_error(item);
  }
}

void ObjectReader::require(std::string_view key) {
  if (!holds(key)) fail(key, "must be given");
}

ObjectReader ObjectReader::object(std::string_view key) {
  const Json* json = find(key);
  if (json != nullptr && !json->is_object()) {
    fail(key, "must be an object");
    json = nullptr;
  }
  return {json == nullptr ? kAbsent : *json, child_pointer(pointer_, key)};
}

void ObjectReader::take_error(const ObjectReader& child) {
  ObjectReader copy = child;
  copy.refuse_unknown_keys();
  if (!error_ && copy.error_) error_ = copy.error_;
}

void ObjectReader::refuse_unknown_keys() {
  if (error_ || !json_->is_object()) return;
  for (const auto& [key, value] : json_->items()) {
    if (known_.contains(key)) continue;
    std::string list;
    for (const std::string& name : known_) list += (list.empty() ? "" : ", ") + name;
    // The key is the client's text: it is echoed only inside JSON, and shortened.
    const std::string shown = key.size() <= 64 ? key : key.substr(0, 64) + "…";
    error_ = Error{ErrorCode::invalid_parameters,
                   fmt::format("\"{}\" is not a parameter; known here: {}.", shown, list),
                   child_pointer(pointer_, shown)};
    return;
  }
}

}  // namespace fairway
