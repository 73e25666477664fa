#pragma once

#include <filesystem>
#include <memory>
#include <mutex>

#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/store/outbox.h"
#include "server/fairwayd/store/sqlite.h"

namespace fairway {

/// Part of a transaction of the job store: a delivery for the webhook of a job that has just come
/// to its end; nothing where the job has no webhook, or the state is none to be told.
Result<void> add_delivery(Database& database, const Job& job);

/// The outbox in the file of an SqliteJobStore, by a connection of its own.
class SqliteOutbox final : public Outbox {
 public:
  /// As SqliteJobStore::open().
  static Result<std::unique_ptr<SqliteOutbox>> open(const std::filesystem::path& path);

  Result<std::optional<DeliveryClaim>> claim(std::string_view owner,
                                             std::chrono::milliseconds lease,
                                             const BusyEndpoints& busy) override;
  Result<void> record(const DeliveryLease& lease, const DeliveryOutcome& outcome) override;
  Result<void> give_back(const DeliveryLease& lease) override;
  Result<std::size_t> release(std::string_view owner) override;
  Result<std::vector<Delivery>> list(std::int64_t job) override;
  Result<Delivery> redeliver(std::int64_t job, std::string_view delivery) override;
  Result<OutboxCounts> counts() override;
  Result<std::vector<std::string>> secrets(std::string_view tenant) override;
  Result<std::string> rotate_secret(std::string_view tenant) override;

 private:
  explicit SqliteOutbox(Database database) : database_(std::move(database)) {}

  Result<std::optional<DeliveryClaim>> next_due(const BusyEndpoints& busy);
  Result<void> log_attempt(std::int64_t delivery, const DeliveryAttempt& attempt);
  Result<std::vector<DeliveryAttempt>> attempts(std::int64_t delivery);
  Result<std::vector<std::string>> secrets_in_force(std::string_view tenant);
  Result<std::string> add_secret(std::string_view tenant);

  std::mutex mutex_;
  Database database_;
};

}  // namespace fairway
