// Strict reading of one JSON object, and the schema of what is read.

#include "proto/messages/object_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "proto/messages/schema_parts.h"

namespace fairway {
namespace {

const Json kAbsent;

constexpr int kLastIndex = std::numeric_limits<int>::max();

/// The whole number from `low` to `high` that a value is, if it is one.
std::optional<int> whole_number(const Json& json, int low, int high) {
  const double value = json.is_number() ? json.get<double>() : NAN;
  if (value >= low && value <= high && value == std::floor(value)) return static_cast<int>(value);
  return std::nullopt;
}

}  // namespace

ObjectReader::ObjectReader(const Json& json, std::string pointer)
    : json_(&json), pointer_(std::move(pointer)) {}

ObjectReader ObjectReader::describing() {
  ObjectReader reader(kAbsent, "");
  reader.schema_ = schema_parts::object();
  return reader;
}

Json ObjectReader::schema() const {
  return schema_.value_or(Json());
}

bool ObjectReader::holds(std::string_view key) const {
  return json_->is_object() && json_->contains(key);
}

const Json* ObjectReader::find(std::string_view key) {
  known_.emplace(key);
  return !error_ && holds(key) ? &*json_->find(key) : nullptr;
}

bool ObjectReader::is_auto(std::string_view key) const {
  const Json& json = *json_->find(key);
  return json.is_string() && json.get_ref<const std::string&>() == kAuto;
}

void ObjectReader::fail(std::string_view key, std::string_view reason) {
  if (error_) return;
  error_ = Error{ErrorCode::invalid_parameters, fmt::format("\"{}\" {}.", key, reason),
                 child_pointer(pointer_, key)};
}

void ObjectReader::fail_item(std::string_view key, std::size_t item, std::string_view reason) {
  if (error_) return;
  error_ =
      Error{ErrorCode::invalid_parameters, fmt::format("\"{}\" item {} {}.", key, item, reason),
            fmt::format("{}/{}", child_pointer(pointer_, key), item)};
}

void ObjectReader::fail_choice(std::string_view key, const std::vector<std::string_view>& names) {
  fail(key, fmt::format("must be one of {}", fmt::join(names, ", ")));
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
  const std::optional<int> value = whole_number(json, low, high);
  if (!value) {
    fail(key, fmt::format("must be a whole number from {} to {}{}", low, high, alternative));
  }
  return value;
}

void ObjectReader::describe(std::string_view key, Json schema) {
  if (schema_) (*schema_)["properties"][std::string(key)] = std::move(schema);
}

void ObjectReader::describe_choice(std::string_view key, const std::vector<std::string_view>& names,
                                   std::string_view chosen) {
  describe(key, {{"type", "string"}, {"enum", names}, {"default", chosen}});
}

/// What stands at `key` already, or the alternative, which comes last and has no default.
void ObjectReader::describe_either(std::string_view key, Json alternative) {
  if (!schema_) return;
  Json& property = (*schema_)["properties"][std::string(key)];
  property = schema_parts::either(std::move(property), std::move(alternative));
}

void ObjectReader::boolean(std::string_view key, bool& target) {
  describe(key, {{"type", "boolean"}, {"default", target}});
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_boolean()) return fail(key, "must be true or false");
  target = json->get<bool>();
}

void ObjectReader::number(std::string_view key, Range range, double& target) {
  describe(key, schema_parts::with_default(schema_parts::number(range.low, range.high), target));
  const Json* json = find(key);
  if (json == nullptr) return;
  target = number_in(key, *json, range, "").value_or(target);
}

void ObjectReader::number_or_auto(std::string_view key, Range range,
                                  std::optional<double>& target) {
  describe(key, schema_parts::or_constant(schema_parts::number(range.low, range.high), kAuto,
                                          target ? Json(*target) : Json(kAuto)));
  const Json* json = find(key);
  if (json == nullptr || is_auto(key)) return;
  target = number_in(key, *json, range, ", or \"auto\"");
}

void ObjectReader::integer(std::string_view key, int low, int high, int& target) {
  describe(key, schema_parts::with_default(schema_parts::integer(low, high), target));
  const Json* json = find(key);
  if (json == nullptr) return;
  target = integer_in(key, *json, low, high, "").value_or(target);
}

void ObjectReader::integer_or_auto(std::string_view key, int low, int high,
                                   std::optional<int>& target) {
  describe(key, schema_parts::or_constant(schema_parts::integer(low, high), kAuto,
                                          target ? Json(*target) : Json(kAuto)));
  const Json* json = find(key);
  if (json == nullptr || is_auto(key)) return;
  target = integer_in(key, *json, low, high, ", or \"auto\"");
}

void ObjectReader::integer_or_false(std::string_view key, int low, int high, int& target) {
  describe(key, schema_parts::or_constant(schema_parts::integer(low, high), false, target));
  const Json* json = find(key);
  if (json == nullptr) return;
  if (json->is_boolean() && !json->get<bool>()) {
    target = 0;
    return;
  }
  target = integer_in(key, *json, low, high, ", or false").value_or(target);
}

void ObjectReader::integer_or_zero(std::string_view key, int low, int high, int& target) {
  describe(key, schema_parts::or_constant(schema_parts::integer(low, high), 0, target));
  const Json* json = find(key);
  if (json == nullptr) return;
  if (const auto zero = whole_number(*json, 0, 0)) {
    target = 0;
    return;
  }
  target = integer_in(key, *json, low, high, ", or 0").value_or(target);
}

void ObjectReader::text(std::string_view key, TextForm form,
                        const std::function<std::string(std::string_view)>& complain,
                        std::string& target) {
  describe(key, {{"type", "string"}, {"maxLength", form.most_bytes}, {"pattern", form.pattern}});
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_string()) return fail(key, "must be a string");
  const auto& value = json->get_ref<const std::string&>();
  if (const std::string wrong = complain(value); !wrong.empty()) return fail(key, wrong);
  target = value;
}

void ObjectReader::names(std::string_view key, std::span<const std::string_view> names,
                         std::span<const std::string_view> aliases,
                         std::vector<std::size_t>& target) {
  if (schema_) describe(key, schema_parts::names(names, aliases, target));
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_array()) return fail(key, "must be a list of names");
  target.clear();
  read_names(key, *json, names, aliases, target);
  std::sort(target.begin(), target.end());
}

void ObjectReader::read_names(std::string_view key, const Json& list,
                              std::span<const std::string_view> names,
                              std::span<const std::string_view> aliases,
                              std::vector<std::size_t>& target) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_string()) return fail_item(key, i, "must be a name");
    const auto& name = list[i].get_ref<const std::string&>();
    std::size_t which = 0;
    while (which < names.size() && name != names[which] && name != aliases[which]) ++which;
    if (which == names.size()) {
      return fail_item(key, i, fmt::format("must be one of {}", fmt::join(names, ", ")));
    }
    if (std::find(target.begin(), target.end(), which) != target.end()) {
      return fail_item(key, i, "is named twice");
    }
    target.push_back(which);
  }
}

void ObjectReader::indices(std::string_view key, ListSize size, std::vector<Index>& target) {
  if (schema_) describe(key, schema_parts::indices(size.least, size.most, kLastIndex));
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_array()) return fail(key, "must be a list of indices");
  if (json->size() > size.most) {
    return fail(key, fmt::format("must have at most {} entries", size.most));
  }
  if (json->size() < size.least) return fail(key, "must name something, or be left out");
  target.reserve(json->size());
  for (std::size_t i = 0; i < json->size(); ++i) {
    const std::optional<int> value = whole_number((*json)[i], 0, kLastIndex);
    if (!value) {
      return fail_item(key, i, fmt::format("must be a whole number from 0 to {}", kLastIndex));
    }
    target.push_back(static_cast<Index>(*value));
  }
}

void ObjectReader::texts(std::string_view key, std::size_t most, std::string_view pattern,
                         bool (*accept)(std::string_view), std::vector<std::string>& target) {
  if (schema_) {
    describe(key, Json{{"type", "array"},
                       {"maxItems", most},
                       {"items", {{"type", "string"}, {"pattern", pattern}}}});
  }
  const Json* json = find(key);
  if (json == nullptr) return;
  if (!json->is_array()) return fail(key, "must be a list of texts");
  if (json->size() > most) {
    return fail_item(key, most, fmt::format("is one too many: there may be {}", most));
  }
  for (std::size_t i = 0; i < json->size(); ++i) {
    const Json& item = (*json)[i];
    if (!item.is_string() || !accept(item.get_ref<const std::string&>())) {
      return fail_item(key, i, fmt::format("must be a text that matches {}", pattern));
    }
    target.push_back(item.get<std::string>());
  }
}

void ObjectReader::object_if_given(std::string_view key, const ReadObject& read) {
  if (find(key) == nullptr && !schema_) return;
  ObjectReader child = object(key);
  if (error_) return;
  read(child);
  take_error(child);
}

void ObjectReader::object_or(std::string_view key, const ReadObject& read,
                             const std::function<void()>& otherwise) {
  if (schema_) {
    ObjectReader child = describing();
    read(child);
    otherwise();
    return describe_either(key, child.schema());
  }
  if (!holds(key) || !json_->find(key)->is_object()) return otherwise();
  ObjectReader child = object(key);
  read(child);
  take_error(child);
}

void ObjectReader::objects_or(std::string_view key, const ReadObject& read,
                              const std::function<void()>& otherwise) {
  if (schema_) {
    ObjectReader item = describing();
    read(item);
    otherwise();
    return describe_either(key, {{"type", "array"}, {"minItems", 1}, {"items", item.schema()}});
  }
  const Json* json = holds(key) ? &*json_->find(key) : nullptr;
  if (json == nullptr || !json->is_array() || json->empty() || !json->front().is_object()) {
    return otherwise();
  }
  read_objects(key, read);
}

void ObjectReader::read_objects(std::string_view key, const ReadObject& read) {
  const Json* json = find(key);
  if (json == nullptr) return;
  for (std::size_t i = 0; i < json->size() && !error_; ++i) {
    if (!(*json)[i].is_object()) return fail_item(key, i, "must be an object");
    ObjectReader item((*json)[i], fmt::format("{}/{}", child_pointer(pointer_, key), i));
    read(item);
    take_error(item);
  }
}

void ObjectReader::not_both(std::string_view key, std::string_view other) {
  if (schema_) (*schema_)["not"] = schema_parts::both_numbers(key, other);
  const auto is_number = [this](std::string_view name) {
    return holds(name) && json_->find(name)->is_number();
  };
  if (is_number(key) && is_number(other)) {
    fail(key, fmt::format("stands together with {}; give one of the two", other));
  }
}

void ObjectReader::require(std::string_view key) {
  if (schema_) {
    (*schema_)["required"].push_back(key);
  } else if (!holds(key)) {
    fail(key, "must be given");
  }
}

ObjectReader ObjectReader::object(std::string_view key) {
  const Json* json = find(key);
  if (json != nullptr && !json->is_object()) {
    fail(key, "must be an object");
    json = nullptr;
  }
  ObjectReader child(json == nullptr ? kAbsent : *json, child_pointer(pointer_, key));
  if (schema_) child.schema_ = schema_parts::object();
  child.key_ = key;
  return child;
}

void ObjectReader::take_error(const ObjectReader& child) {
  if (schema_) return describe(child.key_, child.schema());
  ObjectReader copy = child;
  copy.refuse_unknown_keys();
  if (!error_ && copy.error_) error_ = copy.error_;
}

void ObjectReader::refuse_unknown_keys() {
  if (error_ || !json_->is_object()) return;
  for (const auto& [key, value] : json_->items()) {
    if (known_.contains(key)) continue;
    // The key is the client's text: it is echoed only inside JSON, and shortened.
    const std::string shown = key.size() <= 64 ? key : key.substr(0, 64) + "…";
    error_ = Error{
        ErrorCode::invalid_parameters,
        fmt::format("\"{}\" is not a parameter; known here: {}.", shown, fmt::join(known_, ", ")),
        child_pointer(pointer_, shown)};
    return;
  }
}

}  // namespace fairway
