#pragma once

#include "server/fairwayd/api/cross_origin.h"
#include "server/fairwayd/api/gate.h"
#include "server/fairwayd/api/routes.h"
#include "server/fairwayd/http/http_engine.h"
#include "server/fairwayd/operations/readiness.h"
#include "server/fairwayd/store/blob_store.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/store/outbox.h"
#include "server/fairwayd/telemetry/log.h"
#include "server/fairwayd/work/service_metrics.h"

namespace fairway {

/// What stands between a listener and the API: answers what those who run the service ask
/// (/livez, /readyz, /metrics) and what browsers ask (CORS), and counts and logs every answer.
class Operations final : public HttpApplication {
 public:
  struct Parts {
    HttpApplication& api;
    JobStore& jobs;
    BlobStore& blobs;
    Outbox& outbox;
    Readiness& readiness;
    const Gate& gate;
    const CrossOrigin& cross_origin;
    ServiceMetrics& metrics;
    const Log& log;
    NameValues tus = {};  ///< what OPTIONS tells where uploads are resumed
  };

  /// All parts must outlive it.
  Operations(const Parts& parts, Entrance entrance) : parts_(parts), entrance_(entrance) {}

  bool wants_body(const HttpRequest& request) const override;
  HttpResponse answer(const HttpRequest& request, BodySource& body) override;
  bool is_vital(std::string_view method, std::string_view path) const override;
  void answered(const HttpExchange& exchange) override;
  void connections_changed(int by) override;

 private:
  HttpResponse choose(const HttpRequest& request, BodySource& body);
  HttpResponse show_readiness(const HttpRequest& request);
  HttpResponse show_metrics(const HttpRequest& request);

  const Parts parts_;
  const Entrance entrance_;
};

}  // namespace fairway
