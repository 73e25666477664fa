#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "proto/messages/json.h"

/// Pieces of JSON Schema (draft 2020-12) that an ObjectReader describes itself with.
namespace fairway::schema_parts {

/// An object without any property yet, closed to others.
Json object();
/// A number, a whole number within bounds, both included.
Json number(double low, double high);
Json integer(int low, int high);

Json with_default(Json schema, Json value);
/// `schema` or exactly `constant`, with a default.
Json or_constant(Json schema, const Json& constant, const Json& value);
/// `first`, whose default is kept, or `second`.
Json either(Json first, Json second);

/// A list of indices up to `last`; its default is the empty list, where that is allowed.
Json indices(std::size_t least, std::size_t most, int last);
/// A list of names, or of their other spellings, none named twice; `chosen` are the default's.
Json names(std::span<const std::string_view> names, std::span<const std::string_view> aliases,
           const std::vector<std::size_t>& chosen);
/// An object that has numbers at both keys.
Json both_numbers(std::string_view key, std::string_view other);

}  // namespace fairway::schema_parts
