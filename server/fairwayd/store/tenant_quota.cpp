#include "server/fairwayd/store/tenant_quota.h"

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::string_view kTenantBytes = "SELECT most_bytes FROM tenant WHERE name = ?";
constexpr std::string_view kKeptBytes =
    "SELECT (SELECT coalesce(sum(input_bytes + coalesce(result_bytes, 0)), 0) FROM job "
    "WHERE tenant = ?1 AND state <> 'expired') + "
    "(SELECT coalesce(sum(length), 0) FROM upload WHERE tenant = ?1 AND sha256 IS NULL)";

}  // namespace

Result<void> check_tenant_quota(Database& database, std::string_view tenant, std::uint64_t bytes,
                                std::uint64_t quota) {
  Query own = database.query(kTenantBytes);
  auto row = own.bind(tenant).step();
  if (!row) return row.error();
  const auto most = *row && !own.is_null(0) ? static_cast<std::uint64_t>(own.integer(0)) : quota;
  if (most == 0) return {};
  Query query = database.query(kKeptBytes);
  if (auto sum = query.bind(tenant).step(); !sum) return sum.error();
  const auto kept = static_cast<std::uint64_t>(query.integer(0));
  if (kept <= most && bytes <= most - kept) return {};
  return Error{
      ErrorCode::quota_exceeded,
      fmt::format("{} bytes of {} are kept for this tenant, and {} more would come: delete "
                  "jobs or uploads, or wait until they expire.",
                  kept, most, bytes)};
}

}  // namespace fairway
