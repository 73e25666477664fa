#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"
#include "proto/messages/json.h"

namespace fairway {

/// Largest whole number a JSON document can be trusted with (2^53).
inline constexpr std::uint64_t kMaxCount = std::uint64_t{1} << 53;
inline constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// One value of a glTF document with the place where it stands. Reads members strictly: every
/// getter answers invalid_mesh with the pointer of the culprit for a wrong type or a value out of
/// range. Cheap to copy; the Json must outlive it.
class JsonPlace {
 public:
  JsonPlace(const Json& json, std::string pointer) : json_(&json), pointer_(std::move(pointer)) {}

  const Json& json() const { return *json_; }
  const std::string& pointer() const { return pointer_; }
  std::size_t size() const { return json_->size(); }

  /// invalid_mesh at this place, or at the member `key` of it.
  Error error(std::string_view reason) const;
  Error error_at(std::string_view key, std::string_view reason) const;

  /// The member, if this is an object that has it.
  std::optional<JsonPlace> find(std::string_view key) const;
  bool has(std::string_view key) const;
  /// Element of an array; `index` < size().
  JsonPlace operator[](std::size_t index) const;

  /// A member that must be an object, or an array, if it is there.
  Result<std::optional<JsonPlace>> object(std::string_view key) const;
  Result<std::optional<JsonPlace>> array(std::string_view key) const;

  /// A whole number 0 … kMaxCount.
  Result<std::optional<std::uint64_t>> count(std::string_view key) const;
  Result<std::uint64_t> count_or(std::string_view key, std::uint64_t fallback) const;
  Result<std::uint64_t> required_count(std::string_view key) const;

  /// A whole number below `limit`, the size of the list it points into.
  Result<std::optional<std::size_t>> index(std::string_view key, std::size_t limit) const;
  Result<std::size_t> required_index(std::string_view key, std::size_t limit) const;

  Result<bool> flag(std::string_view key) const;
  /// The text of a member, "" where it is absent.
  Result<std::string_view> text(std::string_view key) const;

  /// This value itself as a whole number.
  Result<std::uint64_t> as_count() const;

 private:
  const Json* json_;
  std::string pointer_;
};

/// The array at `key` of an object of the DOM, made where it is absent.
Json& array_of(Json& object, const char* key);

}  // namespace fairway
