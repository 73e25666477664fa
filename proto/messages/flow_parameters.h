#pragma once

#include "core/flow_options.h"
#include "proto/messages/json.h"
#include "proto/messages/object_reader.h"

namespace fairway {

/// Takes what steers the flow, from "method" to "guards", from a parameter document.
FlowOptions read_flow(ObjectReader& reader);

/// Puts the same keys, every one stated, into a parameter document.
void add_flow(const FlowOptions& flow, Json& document);

}  // namespace fairway
