#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tests/service/contract/contract_walk.h"
#include "tests/service/support/http_exchange.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_scene.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::test {

/// A service of its own over a directory of its own.
struct Stage {
  explicit Stage(const std::vector<std::string>& options = {})
      : service(directory.path(), options) {}

  Answer ask(const WireRequest& request) const { return exchange(service.port(), request); }
  HttpClient client() const { return service.client(); }

  TemporaryDirectory directory;
  ServiceProcess service;
};

/// Provokes everything that is documented of one operation.
using Walk = void (*)(ContractWalk&);

/// By the id of the operation. Every operation of the document has one.
std::map<std::string, Walk> contract_walks();

// The walks of the operations that take a mesh, of jobs, of results, and of uploads.
void walk_submit_job(ContractWalk& walk);
void walk_put_job(ContractWalk& walk);
void walk_denoise(ContractWalk& walk);
void walk_inspect(ContractWalk& walk);
void walk_list_jobs(ContractWalk& walk);
void walk_show_job(ContractWalk& walk);
void walk_delete_job(ContractWalk& walk);
void walk_cancel_job(ContractWalk& walk);
void walk_retry_job(ContractWalk& walk);
void walk_follow_job(ContractWalk& walk);
void walk_show_result(ContractWalk& walk);
void walk_list_deliveries(ContractWalk& walk);
void walk_redeliver(ContractWalk& walk);
void walk_describe_uploads(ContractWalk& walk);
void walk_create_upload(ContractWalk& walk);
void walk_show_upload(ContractWalk& walk);
void walk_continue_upload(ContractWalk& walk);
void walk_delete_upload(ContractWalk& walk);

/// Sends the operation's method without a body.
Answer ask(const ContractWalk& walk, const Stage& stage, const std::string& path,
           const std::vector<std::string>& headers = {});

/// A parameter of the query with a value as a client sends it: a list as often as it has entries.
std::string query_text(const Json& parameter, const Json& value);

/// A request of an operation that takes a mesh. Where its path has an {id}, that is a new one.
WireRequest upload(const ContractWalk& walk, const std::string& mesh,
                   const std::string& parameters = "{}");
WireRequest form(const ContractWalk& walk, const std::vector<FormPart>& parts);

/// What all operations share that take a mesh: every way to send one, and to be refused.
void see_uploads(ContractWalk& walk);

/// What those of them share that make a job: keys, options, earlier inputs and results.
void see_submits(ContractWalk& walk);

/// Requests without a key and with a key of each scope, at a service that asks for keys.
void see_keys_asked_for(ContractWalk& walk);
/// A request from a page of another site.
void see_strange_pages(ContractWalk& walk, const Stage& stage);
/// More submits than a minute has.
void see_rate(ContractWalk& walk);
/// A mesh beyond what a tenant may keep, or a worker may hold.
void see_shares(ContractWalk& walk);

/// What any request can meet: a head that cannot be understood or is beyond its limits, and a
/// service whose connections are all taken. `path` is that of the operation with its {id} filled.
void see_common(ContractWalk& walk, const Stage& stage, const std::string& path);

/// What all operations on one job share. The stage is of no use afterwards.
void see_job_refusals(ContractWalk& walk, const Stage& stage);

/// HEAD is the same as GET, but for the body.
void check_head(const ContractWalk& walk, const Stage& stage, const std::string& path);

/// Sends the request once with each example of each header that is documented.
void see_header_examples(ContractWalk& walk, const Stage& stage, const WireRequest& request);

/// Requests of an operation that stop in their head and, where there is one, in their body, until
/// the service has had enough of them.
class SlowRequests {
 public:
  SlowRequests(const Operation& operation, std::uint16_t port);

  /// Waits for the answers.
  void see(ContractWalk& walk);

 private:
  std::vector<RawConnection> connections_;
};

/// Makes every use of the service's store fail.
void break_store(const Stage& stage);

/// A flow that runs until it is stopped, for a noisy_torus(300).
inline const std::string kEndless = R"({"method":"anisotropic_prescribed","steps":10000})";
/// An id that no job has.
inline const std::string kNobody = "AAAAAAAAAAAAAAAAAAAAAA";

/// A mesh that a worker refuses, and the code of its problem.
struct RefusedMesh {
  std::string code;
  std::string bytes;
  std::string parameters = "{}";
};
std::vector<RefusedMesh> refused_meshes();

/// Kills the workers of a service, as they come, until `enough` says so.
void kill_workers_until(const Stage& stage, const std::function<bool()>& enough);

}  // namespace fairway::test
