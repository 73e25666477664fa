#pragma once

#include <optional>

#include "core/flow_options.h"
#include "core/result.h"
#include "proto/messages/json.h"
#include "proto/messages/object_reader.h"

namespace fairway {

/// A document that states a parameter of the flows, but no method, means the flow
/// anisotropic_prescribed: states it.
void choose_method(Json& document);

/// True where the method that is stated is not the variational one.
bool states_flow(const Json& document);

/// Removes what only the variational method uses.
void drop_variational(Json& values);

/// A parameter that the stated method, or by default the variational one, has no use for.
std::optional<Error> refuse_foreign(const Json& document);

/// Takes what steers the flow, from "method" to "guards", from a parameter document.
FlowOptions read_flow(ObjectReader& reader);

/// Puts the keys that the method uses, every one stated, into a parameter document.
void add_flow(const FlowOptions& flow, Json& document);

}  // namespace fairway
