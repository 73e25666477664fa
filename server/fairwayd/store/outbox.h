#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "proto/messages/job_document.h"

namespace fairway {

/// Where a delivery stands: to be sent, sent, or given up.
enum class DeliveryState : std::uint8_t { pending, delivered, dead };

/// "pending" …
std::string_view name_of(DeliveryState state);

/// One try to tell a webhook.
struct DeliveryAttempt {
  UnixMillis at = 0;  ///< its end
  std::chrono::milliseconds took{0};
  std::optional<int> status;  ///< of the answer, if one came
  std::string error;          ///< a sentence; empty exactly if an answer came
};

/// What a webhook is to be told of one end of one job.
struct Delivery {
  std::string id;  ///< "msg_…", the same in every attempt
  std::string event;
  std::string url;
  std::string payload;  ///< JSON, as it was at the job's end
  DeliveryState state = DeliveryState::pending;
  int attempt = 0;  ///< attempts since it was made, or asked for anew
  UnixMillis created = 0;
  std::optional<UnixMillis> next_at;           ///< of the next attempt; exactly if pending
  std::optional<UnixMillis> delivered;         ///< exactly if delivered
  std::vector<DeliveryAttempt> attempts = {};  ///< oldest first, the last kMaxAttemptsKept
};

inline constexpr std::size_t kMaxAttemptsKept = 50;

/// The right to attempt a delivery; see Lease of the JobStore.
struct DeliveryLease {
  std::string delivery;
  std::int64_t fence = 0;
};

struct DeliveryClaim {
  Delivery delivery;  ///< without its attempts
  DeliveryLease lease;
  std::string tenant;
  std::string origin;  ///< see origin_of_url()
  std::string job_id;
  std::string trace_id;
};

/// What became of an attempt.
struct DeliveryOutcome {
  DeliveryAttempt attempt;
  DeliveryState state = DeliveryState::pending;
  UnixMillis next_at = 0;  ///< where it stays pending
};

/// Whom a claim leaves aside, because enough is on its way to them.
struct BusyEndpoints {
  std::vector<std::string> origins = {};
  std::vector<std::string> tenants = {};
};

struct OutboxCounts {
  std::size_t pending = 0;
  std::optional<UnixMillis> oldest_pending;  ///< when it was made
};

/// How long a signing secret signs beside its successor.
inline constexpr std::chrono::hours kSecretOverlap{24};

/// What webhooks are to be told. A delivery is made by the JobStore, in the transaction that ends
/// its job, and goes with the job's row. All operations are atomic and durable when they return,
/// and may be called from any thread. Errors of every operation: unavailable, storage_full,
/// internal, besides those named.
class Outbox {
 public:
  virtual ~Outbox() = default;

  /// Takes the pending delivery that has been due for longest, for `lease` of time; nothing where
  /// none is.
  virtual Result<std::optional<DeliveryClaim>> claim(std::string_view owner,
                                                     std::chrono::milliseconds lease,
                                                     const BusyEndpoints& busy) = 0;

  /// Writes what became of the attempt and ends the lease. Errors: conflict (the lease is lost, or
  /// the job forgotten; nothing was changed).
  virtual Result<void> record(const DeliveryLease& lease, const DeliveryOutcome& outcome) = 0;

  /// Ends the lease as if there had been no attempt. Errors: conflict.
  virtual Result<void> give_back(const DeliveryLease& lease) = 0;

  /// `owner` starts anew: gives back all that it held. Returns how many.
  virtual Result<std::size_t> release(std::string_view owner) = 0;

  /// All deliveries of a job, newest first.
  virtual Result<std::vector<Delivery>> list(std::int64_t job) = 0;

  /// Makes a delivery due now, whatever its state, with all its attempts ahead of it; one that is
  /// on its way now is not sent twice. Errors: not_found.
  virtual Result<Delivery> redeliver(std::int64_t job, std::string_view delivery) = 0;

  virtual Result<OutboxCounts> counts() = 0;

  /// The tenant's secrets in force, the newest first: "whsec_…"; the first is made where there is
  /// none. Errors: not_found (no such tenant).
  virtual Result<std::vector<std::string>> secrets(std::string_view tenant) = 0;

  /// Makes a new secret; the one before it stays in force for kSecretOverlap. Errors: not_found.
  virtual Result<std::string> rotate_secret(std::string_view tenant) = 0;
};

}  // namespace fairway
