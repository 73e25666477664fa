#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "server/fairway-submit/file_outcome.h"
#include "server/fairway-submit/journal.h"
#include "server/fairway-submit/out_directory.h"
#include "server/fairway-submit/payload.h"
#include "server/fairway-submit/plan.h"
#include "server/fairway-submit/server_client.h"
#include "server/os/sha256.h"

namespace fairway {

/// What the files of a batch share. All references must outlive it.
struct BatchContext {
  const SubmitOptions& options;
  const OutDirectory& out;
  Journal& journal;
};

/// The Idempotency-Key of a submit: the same for every try of one attempt, another one for all that
/// is meant as another job.
std::string idempotency_key(const std::string& batch, const std::string& name,
                            const JournalEntry& entry, const SubmitOptions& options);

/// One file's way: upload, wait, fetch, each step written down before the next.
class FileTask {
 public:
  /// References must outlive it.
  FileTask(const BatchContext& context, const BatchFile& file, ServerClient& client);

  /// Once.
  FileOutcome run();
  /// True where the server was not there within the limit: the whole batch has no use any more.
  bool lost_server() const { return lost_server_; }

 private:
  enum class Next { step, start_over, over };

  Next attempt(const Payload& payload);
  Next take_known();
  Next submit(const Payload& payload);
  Next accept(const Payload& payload, const HttpAnswer& answer);
  Next follow();
  Next heed(const Json& job);
  Next fetch();
  Next put_in_place();

  Next begin_attempt();
  Next give_up(const Exchange& exchange);
  Next refuse(const HttpAnswer& answer, bool for_good);
  Next fail(Json problem, bool for_good);
  Next fail(const Error& error, bool for_good = false);
  Next write_down(Next then);

  const BatchContext& context_;
  const BatchFile& file_;
  ServerClient& client_;
  JournalEntry entry_;
  FileOutcome outcome_;
  bool lost_server_ = false;
  std::string etag_;  ///< of the job document
  KeptResult expected_;
  std::optional<AtomicFile> part_;  ///< the result as it comes
  std::optional<Sha256> digest_;
  std::uint64_t received_ = 0;
  std::optional<Error> unwritable_;
};

}  // namespace fairway
