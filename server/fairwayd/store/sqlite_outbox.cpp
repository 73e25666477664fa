// The deliveries of webhooks as rows beside the jobs.

#include "server/fairwayd/store/sqlite_outbox.h"

#include <array>
#include <utility>

#include "proto/messages/webhook_event.h"
#include "proto/messages/webhook_url.h"
#include "server/fairwayd/store/job_facts.h"
#include "server/fairwayd/store/job_schema.h"
#include "server/fairwayd/telemetry/clocks.h"
#include "server/os/random_id.h"

namespace fairway {
namespace {

#define FAIRWAY_DELIVERY_COLUMNS \
  "d.seq, d.id, d.event, d.url, d.payload, d.state, d.attempt, d.created, d.next_at, d.delivered"
constexpr int kBehind = 10;  // the column behind those

constexpr std::string_view kAdd =
    "INSERT INTO webhook_delivery (id, job, revision, tenant, event, url, origin, payload, state, "
    "created, next_at) VALUES (?, ?, ?, ?, ?, ?, ?, ?, 'pending', ?9, ?9)";
constexpr std::string_view kNextDue =
    "SELECT " FAIRWAY_DELIVERY_COLUMNS
    ", d.fence, d.tenant, d.origin, j.id, j.trace_id "
    "FROM webhook_delivery d JOIN job j ON j.seq = d.job "
    "WHERE d.state = 'pending' AND d.next_at <= ? "
    "AND (d.lease_until IS NULL OR d.lease_until < ?) "
    "AND d.origin NOT IN (SELECT value FROM json_each(?)) "
    "AND d.tenant NOT IN (SELECT value FROM json_each(?)) ORDER BY d.next_at, d.seq LIMIT 1";
constexpr std::string_view kClaim =
    "UPDATE webhook_delivery SET fence = fence + 1, lease_owner = ?, lease_until = ? WHERE id = ?";
constexpr std::string_view kRecord =
    "UPDATE webhook_delivery SET state = ?, attempt = attempt + 1, next_at = ?, delivered = ?, "
    "lease_owner = NULL, lease_until = NULL "
    "WHERE id = ? AND fence = ? AND lease_owner IS NOT NULL RETURNING seq";
constexpr std::string_view kGiveBack =
    "UPDATE webhook_delivery SET lease_owner = NULL, lease_until = NULL "
    "WHERE id = ? AND fence = ? AND lease_owner IS NOT NULL";
constexpr std::string_view kRelease =
    "UPDATE webhook_delivery SET lease_owner = NULL, lease_until = NULL WHERE lease_owner = ?";
constexpr std::string_view kLogAttempt =
    "INSERT INTO webhook_attempt (delivery, number, at, took, status, error) "
    "SELECT ?1, coalesce(max(number), 0) + 1, ?2, ?3, ?4, ?5 FROM webhook_attempt "
    "WHERE delivery = ?1";
constexpr std::string_view kTrimAttempts =
    "DELETE FROM webhook_attempt WHERE delivery = ?1 AND number <= "
    "(SELECT max(number) FROM webhook_attempt WHERE delivery = ?1) - ?2";
constexpr std::string_view kList = "SELECT " FAIRWAY_DELIVERY_COLUMNS
                                   " FROM webhook_delivery d WHERE d.job = ? ORDER BY d.seq DESC";
constexpr std::string_view kAttempts =
    "SELECT at, took, status, error FROM webhook_attempt WHERE delivery = ? ORDER BY number";
constexpr std::string_view kRedeliver =
    "UPDATE webhook_delivery SET state = 'pending', attempt = 0, next_at = ?, delivered = NULL "
    "WHERE job = ? AND id = ?";
constexpr std::string_view kFind =
    "SELECT " FAIRWAY_DELIVERY_COLUMNS " FROM webhook_delivery d WHERE d.job = ? AND d.id = ?";
constexpr std::string_view kCount =
    "SELECT count(*), min(created) FROM webhook_delivery WHERE state = 'pending'";

constexpr std::array<std::string_view, 3> kStates = {"pending", "delivered", "dead"};

DeliveryState delivery_state_of(const std::string& name) {
  for (std::size_t i = 0; i < kStates.size(); ++i) {
    if (kStates.at(i) == name) return static_cast<DeliveryState>(i);
  }
  return DeliveryState::dead;
}

std::optional<std::int64_t> optional_integer(const Query& row, int column) {
  return row.is_null(column) ? std::nullopt : std::optional(row.integer(column));
}

/// Of a row over FAIRWAY_DELIVERY_COLUMNS; its first column stays with the caller.
Delivery delivery_of(const Query& row) {
  Delivery delivery;
  delivery.id = row.text(1);
  delivery.event = row.text(2);
  delivery.url = row.text(3);
  delivery.payload = row.text(4);
  delivery.state = delivery_state_of(row.text(5));
  delivery.attempt = static_cast<int>(row.integer(6));
  delivery.created = row.integer(7);
  delivery.next_at = optional_integer(row, 8);
  delivery.delivered = optional_integer(row, 9);
  return delivery;
}

Error late() {
  return {ErrorCode::conflict, "The lease on this delivery is lost."};
}

}  // namespace

std::string_view name_of(DeliveryState state) {
  return kStates.at(static_cast<std::size_t>(state));
}

Result<void> add_delivery(Database& database, const Job& job) {
  if (!job.options.webhook || !is_final(job.state) || job.state == JobState::expired) return {};
  const std::string& url = job.options.webhook->url;
  Query query = database.query(kAdd);
  query.bind("msg_" + random_id()).bind(job.number).bind(job.revision).bind(job.tenant);
  query.bind(webhook_event_type(job.state)).bind(url).bind(origin_of_url(url));
  query.bind(dump_json(webhook_event(facts_of(job)))).bind(wall_clock());
  if (auto done = query.step(); !done) return done.error();
  return {};
}

Result<std::unique_ptr<SqliteOutbox>> SqliteOutbox::open(const std::filesystem::path& path) {
  auto database = Database::open(path);
  if (!database) return database.error();
  if (auto done = migrate_job_schema(*database); !done) return done.error();
  return std::unique_ptr<SqliteOutbox>(new SqliteOutbox(std::move(*database)));
}

Result<std::optional<DeliveryClaim>> SqliteOutbox::next_due(const BusyEndpoints& busy) {
  Query row = database_.query(kNextDue);
  row.bind(wall_clock()).bind(monotonic_millis());
  row.bind(dump_json(Json(busy.origins))).bind(dump_json(Json(busy.tenants)));
  auto found = row.step();
  if (!found) return found.error();
  if (!*found) return std::optional<DeliveryClaim>();
  DeliveryClaim claim;
  claim.delivery = delivery_of(row);
  claim.lease = {claim.delivery.id, row.integer(kBehind) + 1};
  claim.tenant = row.text(kBehind + 1);
  claim.origin = row.text(kBehind + 2);
  claim.job_id = row.text(kBehind + 3);
  claim.trace_id = row.text(kBehind + 4);
  return std::optional(std::move(claim));
}

Result<std::optional<DeliveryClaim>> SqliteOutbox::claim(std::string_view owner,
                                                         std::chrono::milliseconds lease,
                                                         const BusyEndpoints& busy) {
  const std::lock_guard lock(mutex_);
  // Looking is frequent and costs nobody the write lock.
  auto seen = next_due(busy);
  if (!seen || !*seen) return seen;
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  auto claim = next_due(busy);
  if (!claim || !*claim) return claim;
  {
    Query query = database_.query(kClaim);
    query.bind(owner).bind(monotonic_millis() + lease.count()).bind((*claim)->delivery.id);
    if (auto done = query.step(); !done) return done.error();
  }
  if (auto done = transaction->commit(); !done) return done.error();
  return claim;
}

Result<void> SqliteOutbox::record(const DeliveryLease& lease, const DeliveryOutcome& outcome) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  const auto only_in = [&](DeliveryState state, UnixMillis time) {
    return outcome.state == state ? std::optional(time) : std::nullopt;
  };
  std::int64_t delivery = 0;
  {
    Query query = database_.query(kRecord);
    query.bind(name_of(outcome.state)).bind(only_in(DeliveryState::pending, outcome.next_at));
    query.bind(only_in(DeliveryState::delivered, outcome.attempt.at));
    query.bind(lease.delivery).bind(lease.fence);
    auto row = query.step();
    if (!row) return row.error();
    if (!*row) return late();
    delivery = query.integer(0);
  }
  if (auto done = log_attempt(delivery, outcome.attempt); !done) return done;
  return transaction->commit();
}

Result<void> SqliteOutbox::log_attempt(std::int64_t delivery, const DeliveryAttempt& attempt) {
  {
    Query query = database_.query(kLogAttempt);
    query.bind(delivery).bind(attempt.at).bind(std::int64_t{attempt.took.count()});
    attempt.status ? query.bind(std::int64_t{*attempt.status}) : query.bind_null();
    query.bind(attempt.error);
    if (auto done = query.step(); !done) return done.error();
  }
  Query trim = database_.query(kTrimAttempts);
  trim.bind(delivery).bind(static_cast<std::int64_t>(kMaxAttemptsKept));
  if (auto done = trim.step(); !done) return done.error();
  return {};
}

Result<void> SqliteOutbox::give_back(const DeliveryLease& lease) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kGiveBack);
  if (auto done = query.bind(lease.delivery).bind(lease.fence).step(); !done) return done.error();
  if (database_.changes() == 0) return late();
  return {};
}

Result<std::size_t> SqliteOutbox::release(std::string_view owner) {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kRelease);
  if (auto done = query.bind(owner).step(); !done) return done.error();
  return static_cast<std::size_t>(database_.changes());
}

Result<std::vector<Delivery>> SqliteOutbox::list(std::int64_t job) {
  const std::lock_guard lock(mutex_);
  std::vector<Delivery> deliveries;
  Query rows = database_.query(kList);
  rows.bind(job);
  for (;;) {
    auto row = rows.step();
    if (!row) return row.error();
    if (!*row) return deliveries;
    auto tried = attempts(rows.integer(0));
    if (!tried) return tried.error();
    deliveries.push_back(delivery_of(rows));
    deliveries.back().attempts = *std::move(tried);
  }
}

Result<std::vector<DeliveryAttempt>> SqliteOutbox::attempts(std::int64_t delivery) {
  std::vector<DeliveryAttempt> attempts;
  Query rows = database_.query(kAttempts);
  rows.bind(delivery);
  for (;;) {
    auto row = rows.step();
    if (!row) return row.error();
    if (!*row) return attempts;
    DeliveryAttempt attempt;
    attempt.at = rows.integer(0);
    attempt.took = std::chrono::milliseconds(rows.integer(1));
    if (!rows.is_null(2)) attempt.status = static_cast<int>(rows.integer(2));
    attempt.error = rows.text(3);
    attempts.push_back(std::move(attempt));
  }
}

Result<Delivery> SqliteOutbox::redeliver(std::int64_t job, std::string_view delivery) {
  const std::lock_guard lock(mutex_);
  auto transaction = Transaction::begin(database_);
  if (!transaction) return transaction.error();
  {
    Query query = database_.query(kRedeliver);
    auto done = query.bind(wall_clock()).bind(job).bind(delivery).step();
    if (!done) return done.error();
  }
  Delivery again;
  {
    Query query = database_.query(kFind);
    auto row = query.bind(job).bind(delivery).step();
    if (!row) return row.error();
    if (!*row) return Error{ErrorCode::not_found, "The job has no delivery with this id."};
    again = delivery_of(query);
    auto tried = attempts(query.integer(0));
    if (!tried) return tried.error();
    again.attempts = *std::move(tried);
  }
  if (auto done = transaction->commit(); !done) return done.error();
  return again;
}

Result<OutboxCounts> SqliteOutbox::counts() {
  const std::lock_guard lock(mutex_);
  Query query = database_.query(kCount);
  auto row = query.step();
  if (!row) return row.error();
  return OutboxCounts{static_cast<std::size_t>(query.integer(0)), optional_integer(query, 1)};
}

}  // namespace fairway
