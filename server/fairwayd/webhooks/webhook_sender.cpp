#include "server/fairwayd/webhooks/webhook_sender.h"

#include <algorithm>
#include <utility>

#include "server/fairwayd/telemetry/clocks.h"
#include "server/fairwayd/webhooks/webhook_signature.h"

namespace fairway {
namespace {

/// How often the outbox is looked at where nothing is announced: retries become due by themselves.
constexpr std::chrono::milliseconds kLookEvery{1000};
/// The same, while something is on its way.
constexpr std::chrono::milliseconds kPollFor{50};

/// Those that are counted `most` times or more.
std::vector<std::string> full(const std::map<std::string, std::size_t>& counts, std::size_t most) {
  std::vector<std::string> names;
  for (const auto& [name, count] : counts) {
    if (count >= most) names.push_back(name);
  }
  return names;
}

Log about(const Log& log, const DeliveryClaim& claim) {
  return log.with({{"job", claim.job_id},
                   {"trace", claim.trace_id},
                   {"delivery", claim.delivery.id},
                   {"origin", claim.origin}});
}

}  // namespace

WebhookSender::WebhookSender(Outbox& outbox, JobBoard& board, ServiceMetrics& metrics,
                             const Log& log, WebhookSenderOptions options)
    : outbox_(outbox),
      board_(board),
      metrics_(metrics),
      log_(log),
      options_(std::move(options)),
      random_(options_.seed) {}

WebhookSender::~WebhookSender() {
  stop();
}

Result<void> WebhookSender::start() {
  auto client = WebhookClient::create(options_.client);
  if (!client) return client.error();
  client_ = *std::move(client);
  // What a dead server of this name had on its way.
  if (auto released = outbox_.release(options_.owner); !released) return released.error();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  return {};
}

void WebhookSender::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void WebhookSender::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const std::uint64_t turn = board_.turn();
    while (!stop.stop_requested() && begin_next()) {
    }
    if (on_their_way_.empty()) {
      board_.wait(turn, kLookEvery, stop);
      continue;
    }
    for (const PostEnd& end : client_->poll(kPollFor)) conclude(end);
  }
  give_back_all();
}

BusyEndpoints WebhookSender::busy() const {
  std::map<std::string, std::size_t> origins;
  std::map<std::string, std::size_t> tenants;
  for (const auto& [ticket, claim] : on_their_way_) {
    ++origins[claim.origin];
    ++tenants[claim.tenant];
  }
  return {full(origins, options_.most_to_origin), full(tenants, options_.most_of_tenant)};
}

/// False where there is nothing to begin now.
bool WebhookSender::begin_next() {
  if (on_their_way_.size() >= options_.most) return false;
  auto claim = outbox_.claim(options_.owner, options_.lease, busy());
  if (!claim) {
    log_.write(LogLevel::error, "webhooks_not_read", {{"reason", claim.error().message}});
    return false;
  }
  return *claim && begin(**std::move(claim));
}

bool WebhookSender::begin(DeliveryClaim claim) {
  const Delivery& delivery = claim.delivery;
  const auto secrets = outbox_.secrets(claim.tenant);
  const std::int64_t seconds = wall_clock() / 1000;
  WebhookPost post{delivery.url,
                   {{"Content-Type", "application/json"},
                    {"User-Agent", "fairwayd/" + options_.version},
                    {"webhook-id", delivery.id},
                    {"webhook-timestamp", std::to_string(seconds)}},
                   delivery.payload};
  Result<void> started = secrets ? Result<void>() : secrets.error();
  if (started) {
    post.headers.emplace_back("webhook-signature",
                              webhook_signature(*secrets, delivery.id, seconds, post.body));
    started = client_->start(++last_ticket_, std::move(post));
  }
  const DeliveryLease lease = claim.lease;
  if (started) {
    on_their_way_.emplace(last_ticket_, std::move(claim));
    return true;
  }
  about(log_, claim)
      .write(LogLevel::error, "webhook_not_sent", {{"reason", started.error().message}});
  // Where this fails, too, the lease runs out.
  [[maybe_unused]] const auto given_back = outbox_.give_back(lease);
  return false;
}

void WebhookSender::conclude(const PostEnd& end) {
  const auto found = on_their_way_.extract(end.ticket);
  if (found.empty()) return;
  const DeliveryClaim& claim = found.mapped();
  const double jitter = std::uniform_real_distribution<double>(-1.0, 1.0)(random_);
  const Verdict verdict = verdict_on(end, claim.delivery.attempt + 1, options_.first_retry, jitter);
  const UnixMillis now = wall_clock();
  const DeliveryOutcome outcome{{now, end.took, end.status, std::string(sentence_of(end.failure))},
                                verdict.state,
                                now + verdict.delay.count()};
  if (auto recorded = outbox_.record(claim.lease, outcome); !recorded) {
    about(log_, claim)
        .write(LogLevel::error, "webhook_not_recorded", {{"reason", recorded.error().message}});
    return;
  }
  tell(claim, outcome);
}

void WebhookSender::tell(const DeliveryClaim& claim, const DeliveryOutcome& outcome) const {
  const bool delivered = outcome.state == DeliveryState::delivered;
  const bool again = outcome.state == DeliveryState::pending;
  metrics_.webhook_attempted(again ? "retried" : name_of(outcome.state));
  Json answer = outcome.attempt.error;
  if (outcome.attempt.status) answer = *outcome.attempt.status;
  about(log_, claim)
      .write(delivered ? LogLevel::info : LogLevel::warning,
             delivered ? "webhook_delivered" : (again ? "webhook_put_off" : "webhook_given_up"),
             {{"event_type", claim.delivery.event},
              {"attempt", claim.delivery.attempt + 1},
              {"answer", std::move(answer)},
              {"next_at", again ? Json(rfc3339_utc(outcome.next_at)) : Json()},
              {"ms", outcome.attempt.took.count()}});
}

void WebhookSender::give_back_all() {
  client_.reset();
  for (const auto& [ticket, claim] : on_their_way_) {
    if (auto done = outbox_.give_back(claim.lease); !done) {
      about(log_, claim)
          .write(LogLevel::warning, "webhook_not_given_back", {{"reason", done.error().message}});
    }
  }
  on_their_way_.clear();
}

}  // namespace fairway
