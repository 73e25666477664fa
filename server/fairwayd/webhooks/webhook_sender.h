#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <stop_token>
#include <string>
#include <thread>

#include "server/fairwayd/store/outbox.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/fairwayd/webhooks/webhook_client.h"
#include "server/fairwayd/webhooks/webhook_schedule.h"
#include "server/fairwayd/work/job_board.h"
#include "server/fairwayd/work/service_metrics.h"

namespace fairway {

struct WebhookSenderOptions {
  std::string owner = "local";  ///< this sender's lasting name in the outbox
  std::string version;          ///< for the header user-agent
  WebhookClientOptions client;
  std::chrono::milliseconds first_retry = kFirstRetry;
  std::uint64_t seed = 0;  ///< of the jitter
  /// Longer than a POST may take. What is not recorded by then is sent again.
  std::chrono::milliseconds lease = std::chrono::minutes(2);
  // How many may be on their way at a time: who does not answer holds up only what goes to him.
  std::size_t most = 32;
  std::size_t most_to_origin = 4;
  std::size_t most_of_tenant = 16;
};

/// Tells webhooks what the outbox has for them, from one thread. Each delivery arrives at least
/// once, under one id, as long as its endpoint answers 2xx to one of kMaxWebhookAttempts.
class WebhookSender {
 public:
  /// All references must outlive the sender.
  WebhookSender(Outbox& outbox, JobBoard& board, ServiceMetrics& metrics, const Log& log,
                WebhookSenderOptions options);
  /// As stop().
  ~WebhookSender();

  /// Errors: unavailable.
  Result<void> start();

  /// Breaks off what is on its way and gives it back. Idempotent.
  void stop();

 private:
  void run(const std::stop_token& stop);
  bool begin_next();
  bool begin(DeliveryClaim claim);
  BusyEndpoints busy() const;
  void conclude(const PostEnd& end);
  void tell(const DeliveryClaim& claim, const DeliveryOutcome& outcome) const;
  void give_back_all();

  Outbox& outbox_;
  JobBoard& board_;
  ServiceMetrics& metrics_;
  const Log& log_;
  const WebhookSenderOptions options_;

  // Of the thread alone.
  std::unique_ptr<WebhookClient> client_;
  std::map<std::int64_t, DeliveryClaim> on_their_way_;  ///< by the client's tickets
  std::int64_t last_ticket_ = 0;
  std::mt19937_64 random_;

  std::jthread thread_;
};

}  // namespace fairway
