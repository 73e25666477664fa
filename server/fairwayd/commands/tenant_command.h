#pragma once

#include <span>
#include <string>

#include "core/result.h"

namespace fairway {

/// True where the arguments begin with "keys" or "tenants".
bool is_tenant_command(std::span<const char* const> arguments);

/// `fairwayd keys add|list|revoke` and `fairwayd tenants list|set`: who may use the service, and
/// how much of it. Works on the data directory of the settings, beside a service that runs there.
/// `arguments`: those after the program's name; `environment`: "NAME=value". Returns what is to be
/// printed. Errors: usage, not_found, as TenantStore.
Result<std::string> run_tenant_command(std::span<const char* const> arguments,
                                       std::span<const std::string> environment);

}  // namespace fairway
