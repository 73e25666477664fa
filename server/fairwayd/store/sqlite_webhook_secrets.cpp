// The secrets that webhooks are signed with. They are stored as they are: to sign is to know them.

#include "server/fairwayd/store/sqlite_outbox.h"
#include "server/fairwayd/store/webhook_secret.h"
#include "server/fairwayd/telemetry/clocks.h"

namespace fairway {
namespace {

constexpr std::string_view kInForce =
    "SELECT secret FROM webhook_secret WHERE tenant = ? AND (until IS NULL OR until > ?) "
    "ORDER BY until IS NULL DESC, until DESC";
constexpr std::string_view kFindTenant = "SELECT 1 FROM tenant WHERE name = ?";
constexpr std::string_view kAdd =
    "INSERT INTO webhook_secret (tenant, secret, created) VALUES (?, ?, ?)";
constexpr std::string_view kRetire =
    "UPDATE webhook_secret SET until = ? WHERE tenant = ? AND until IS NULL";
constexpr std::string_view kForget = "DELETE FROM webhook_secret WHERE tenant = ? AND until <= ?";

}  // namespace

Result<std::vector<std::string>> SqliteOutbox::secrets_in_force(std::string_view tenant) {
  std::vector<std::string> secrets;
  Query rows = database_.query(kInForce);
  rows.bind(tenant).bind(wall_clock());
  for (;;) {
    auto row = rows.step();
    if (!row) return row.error();
    if (!*row) return secrets;
    secrets.push_back(rows.text(0));
  }
}

Result<std::string> SqliteOutbox::add_secret(std::string_view tenant) {
  {
    Query query = database_.query(kFindTenant);
    const auto there = query.bind(tenant).step();
    if (!there) return there.error();
    if (!*there) return Error{ErrorCode::not_found, "There is no tenant of this name."};
  }
  std::string secret = new_webhook_secret();
  Query query = database_.query(kAdd);
  auto done = query.bind(tenant).bind(secret).bind(wall_clock()).step();
  if (!done) return done.error();
  return secret;
}

Result<std::vector<std::string>> SqliteOutbox::secrets(std::string_view tenant) {
  const std::lock_guard lock(mutex_);
  auto there = secrets_in_force(tenant);
  if (!there || !there->empty()) return there;
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  // Another process may have made it in between.
  there = secrets_in_force(tenant);
  if (!there || !there->empty()) return there;
  auto secret = add_secret(tenant);
  if (!secret) return secret.error();
  if (auto done = transaction->commit(); !done) return done.error();
  return std::vector{*std::move(secret)};
}

Result<std::string> SqliteOutbox::rotate_secret(std::string_view tenant) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  const UnixMillis now = wall_clock();
  {
    Query retire = database_.query(kRetire);
    const auto until = now + std::chrono::milliseconds(kSecretOverlap).count();
    if (auto done = retire.bind(until).bind(tenant).step(); !done) return done.error();
    Query forget = database_.query(kForget);
    if (auto done = forget.bind(tenant).bind(now).step(); !done) return done.error();
  }
  auto secret = add_secret(tenant);
  if (!secret) return secret;
  if (auto done = transaction->commit(); !done) return done.error();
  return secret;
}

}  // namespace fairway
