// What the webhook of a job was told, and telling it again.

#include <utility>

#include "proto/messages/webhook_url.h"
#include "server/fairwayd/api/api.h"
#include "server/fairwayd/work/job_log.h"

namespace fairway {
namespace {

Json attempt_document(const DeliveryAttempt& attempt) {
  Json document{{"at", rfc3339_utc(attempt.at)}, {"ms", attempt.took.count()}};
  if (attempt.status) document["status"] = *attempt.status;
  if (!attempt.error.empty()) document["error"] = attempt.error;
  return document;
}

Json delivery_document(const Job& job, const Delivery& delivery) {
  Json document{{"id", delivery.id},
                {"event", delivery.event},
                {"url", shown_url(delivery.url)},
                {"state", name_of(delivery.state)},
                {"created", rfc3339_utc(delivery.created)}};
  if (delivery.next_at) document["next_at"] = rfc3339_utc(*delivery.next_at);
  if (delivery.delivered) document["delivered"] = rfc3339_utc(*delivery.delivered);
  document["attempts"] = Json::array();
  for (const DeliveryAttempt& attempt : delivery.attempts) {
    document["attempts"].push_back(attempt_document(attempt));
  }
  document["links"] =
      Json{{"redeliver", "/v1/jobs/" + job.id + "/deliveries/" + delivery.id + "/redeliver"}};
  return document;
}

}  // namespace

HttpResponse Api::list_deliveries(const JobName& name) {
  const auto job = jobs_.find(name);
  if (!job) return refuse(job.error());
  const auto deliveries = outbox_.list(job->number);
  if (!deliveries) return refuse(deliveries.error());
  Json documents = Json::array();
  for (const Delivery& delivery : *deliveries) {
    documents.push_back(delivery_document(*job, delivery));
  }
  return json_response(Json{{"deliveries", std::move(documents)}});
}

HttpResponse Api::redeliver(const JobName& name, const std::string& delivery_id) {
  const auto job = jobs_.find(name);
  if (!job) return refuse(job.error());
  const auto delivery = outbox_.redeliver(job->number, delivery_id);
  if (!delivery) return refuse(delivery.error());
  about(log_, *job).write(LogLevel::info, "webhook_asked_anew", {{"delivery", delivery->id}});
  board_.announce();
  return json_response(delivery_document(*job, *delivery), 202);
}

}  // namespace fairway
