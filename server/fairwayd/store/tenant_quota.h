#pragma once

#include <cstdint>
#include <string_view>

#include "core/result.h"
#include "server/fairwayd/store/sqlite.h"

namespace fairway {

/// Whether `bytes` more may be kept of a tenant, beside the meshes of its jobs and its open uploads
/// at their full length. `quota`: of a tenant that has none of its own; 0: any. In the transaction
/// that adds them. Errors: quota_exceeded, as Query::step().
Result<void> check_tenant_quota(Database& database, std::string_view tenant, std::uint64_t bytes,
                                std::uint64_t quota);

}  // namespace fairway
