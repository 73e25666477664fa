#pragma once

#include <string>

#include "proto/messages/json.h"

namespace fairway::test {

/// What of `value` breaks the JSON Schema `schema`: "" where nothing does, otherwise the pointer of
/// the first culprit and the keyword. `root` is where local references ("#/…") lead. Knows the
/// keywords of draft 2020-12 that the project's schemas use; another keyword is a fault, too, so
/// that none is passed over.
std::string schema_fault(const Json& value, const Json& schema, const Json& root);

}  // namespace fairway::test
