// How to get every documented answer about uploads in pieces.

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <sys/resource.h>

#include "server/fairwayd/store/sqlite.h"
#include "tests/service/contract/contract_walks.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/uploads/tus_client.h"

namespace fairway::test {
namespace {

using Headers = std::vector<std::string>;

const std::string kVersion = "Tus-Resumable: 1.0.0";
const std::string kPieceType = "Content-Type: application/offset+octet-stream";
/// Of other bytes than any that are sent here.
const std::string kWrongSum = "Upload-Checksum: sha1 AAAAAAAAAAAAAAAAAAAAAAAAAAA=";

WireRequest creation(std::uint64_t length, const std::string& bytes = {},
                     const Headers& more = {}) {
  WireRequest request{"POST",
                      "/v1/uploads",
                      {kVersion, "Upload-Length: " + std::to_string(length), kPieceType},
                      bytes};
  request.headers.insert(request.headers.end(), more.begin(), more.end());
  return request;
}

WireRequest piece(const std::string& path, std::uint64_t offset, const std::string& bytes,
                  const Headers& more = {}) {
  WireRequest request{
      "PATCH", path, {kVersion, "Upload-Offset: " + std::to_string(offset), kPieceType}, bytes};
  request.headers.insert(request.headers.end(), more.begin(), more.end());
  return request;
}

/// Follows one operation at one service.
class Asker {
 public:
  Asker(ContractWalk& walk, const Stage& stage) : walk_(walk), stage_(stage) {}

  Answer operator()(const WireRequest& request) const {
    Answer answer = stage_.ask(request);
    walk_.see(answer);
    return answer;
  }

  /// A request of the operation that needs no body.
  WireRequest request(const std::string& path) const {
    if (walk_.operation().method == "PATCH") return piece(path, 0, "0");
    return {walk_.operation().method, path, {kVersion}, ""};
  }

 private:
  ContractWalk& walk_;
  const Stage& stage_;
};

/// An upload that has become a job.
std::string used_upload(const Stage& stage) {
  std::string path = TusClient(stage.client()).upload(small_glb());
  REQUIRE(stage.client().post("/v1/jobs?upload=" + id_of_upload(path)).status == 202);
  return path;
}

/// Uploads that are not there, no longer there, or asked for in another version.
void see_absences(const Asker& ask, const Stage& stage) {
  const TusClient client(stage.client());
  CHECK(ask(ask.request("/v1/uploads/" + kNobody)).status == 404);
  CHECK(ask(ask.request("/v1/uploads/no-id")).status == 404);
  CHECK(ask(ask.request(used_upload(stage))).status == 410);
  const std::string path = client.created(10);
  WireRequest old = ask.request(path);
  old.headers[0] = "Tus-Resumable: 0.2.2";
  CHECK(ask(old).header("tus-version") == "1.0.0");
  old.headers.erase(old.headers.begin());
  CHECK(ask(old).status == 412);
  CHECK(client.offset(path) == 0);
  auto database = Database::open(stage.directory.path() / "jobs.sqlite");
  REQUIRE(database);
  REQUIRE(database->execute("UPDATE upload SET expires = 1"));
  const int expired = ask(ask.request(path)).status;
  CHECK((expired == 410 || expired == 404));  // the sweeper may have been there
}

/// The directory of uploads, then their table, cannot be used. The stage is of no use afterwards.
void see_defects(const Asker& ask, const Stage& stage, const WireRequest& request) {
  const std::filesystem::path uploads = stage.directory.path() / "uploads";
  std::filesystem::remove_all(uploads);
  std::ofstream(uploads) << "no directory";
  CHECK(ask(request).status == 503);
  std::filesystem::remove(uploads);
  std::filesystem::create_directory(uploads);
  break_store(stage);
  CHECK(ask(request).status == 500);
}

/// What all operations on one upload share.
void see_upload_refusals(ContractWalk& walk) {
  const Stage stage;
  const Asker ask(walk, stage);
  see_absences(ask, stage);
  const std::string path = TusClient(stage.client()).created(10);
  see_common(walk, stage, path);
  see_defects(ask, stage, ask.request(path));
}

/// A limit of file sizes is what a test can set without a disk of its own to fill.
void limit_files(const Stage& stage) {
  const rlimit limit{std::size_t{64} << 10, std::size_t{64} << 10};
  REQUIRE(::prlimit(stage.service.pid(), RLIMIT_FSIZE, &limit, nullptr) == 0);
}

/// Bytes of an upload are waited for when the service stops.
void see_stop(ContractWalk& walk, const WireRequest& request, Stage& stage) {
  std::string head = request.method + " " + request.path + " HTTP/1.1\r\nHost: t\r\n";
  for (const std::string& header : request.headers) head += header + "\r\n";
  RawConnection slow(stage.service.port());
  slow.send(head + "Content-Length: 9\r\nExpect: 100-continue\r\n\r\n");
  slow.read_until("100 Continue\r\n\r\n");
  CHECK(stage.service.stop().code == 0);
  const Answer answer = parsed_answer(slow.read_all());
  CHECK(answer.problem() == "unavailable");
  walk.see(answer);
}

void see_creations(const Asker& ask, const ContractWalk& walk) {
  for (const Json& parameter : walk.operation().parameters) {
    if (parameter["in"] != "header") continue;
    const std::string name = parameter["name"];
    CAPTURE(name);
    WireRequest request = creation(1048576);
    std::erase_if(request.headers, [&](const std::string& h) { return h.starts_with(name + ":"); });
    request.headers.push_back(name + ": " + parameter["example"].get<std::string>());
    CHECK(ask(request).status == 201);
  }
  CHECK(ask(creation(10, "0123")).header("upload-offset") == "4");
}

void see_creation_refusals(const Asker& ask) {
  CHECK(ask(creation(10, "0123", {kWrongSum})).problem() == "checksum_mismatch");
  CHECK(ask(creation(10, "0123", {"Upload-Checksum: md5 AAAA"})).status == 400);
  CHECK(ask(creation(10, "", {"Upload-Metadata: filename *"})).status == 400);
  CHECK(ask(creation(0)).status == 400);
  CHECK(ask({"POST", "/v1/uploads", {kVersion}, ""}).status == 400);
  CHECK(ask({"POST", "/v1/uploads", {"Upload-Length: 10"}, ""}).status == 412);
  CHECK(ask(creation(4, "01234")).problem() == "too_large");
  CHECK(ask(creation(std::uint64_t{1} << 40)).problem() == "too_large");
  CHECK(ask(creation(10, "0123", {"Content-Encoding: gzip"})).status == 415);
}

}  // namespace

void walk_describe_uploads(ContractWalk& walk) {
  const Stage stage;
  const Asker ask(walk, stage);
  for (const std::string& path : {std::string("/v1/uploads"), "/v1/uploads/" + kNobody}) {
    const Answer told = ask({"OPTIONS", path, {}, ""});
    CHECK(told.status == 204);
    CHECK(told.header("tus-max-size") == std::to_string(std::uint64_t{512} << 20));
  }
  see_common(walk, stage, "/v1/uploads");
}

void walk_create_upload(ContractWalk& walk) {
  const Stage stage;
  const Asker ask(walk, stage);
  see_creations(ask, walk);
  see_creation_refusals(ask);
  see_common(walk, stage, "/v1/uploads");
  for (int i = 0; i < 100; ++i) stage.ask(creation(1));
  CHECK(ask(creation(1)).problem() == "rate_limited");
  const Stage full({"--min-free", "281474976710656"});
  CHECK(Asker(walk, full)(creation(10)).problem() == "storage_full");
  const Stage narrow({"--quota", "100"});
  CHECK(Asker(walk, narrow)(creation(101)).problem() == "quota_exceeded");
  Stage stopping;
  see_stop(walk, creation(9), stopping);
  const Stage broken;
  see_defects({walk, broken}, broken, creation(10));
}

void walk_show_upload(ContractWalk& walk) {
  const Stage stage;
  const Asker ask(walk, stage);
  const TusClient client(stage.client());
  const std::string plain = client.created(10);
  client.patch(plain, 0, "0123");
  const Answer there = ask(ask.request(plain));
  CHECK(there.status == 200);
  CHECK(there.header("upload-offset") == "4");
  const std::string named = client.created(10, {{"Upload-Metadata", "filename bWVzaC5vYmo="}});
  CHECK(ask(ask.request(named)).header("upload-metadata") == "filename bWVzaC5vYmo=");
  see_header_examples(walk, stage, ask.request(plain));
  see_upload_refusals(walk);
}

void walk_continue_upload(ContractWalk& walk) {
  const Stage stage;
  const Asker ask(walk, stage);
  const TusClient client(stage.client());
  const std::string path = client.created(200000);
  see_header_examples(walk, stage, piece(path, 0, ""));
  CHECK(ask(piece(path, 0, "0123")).header("upload-offset") == "4");
  WireRequest posted = piece(path, 4, "4567", {"X-HTTP-Method-Override: PATCH"});
  posted.method = "POST";
  CHECK(ask(posted).header("upload-offset") == "8");
  CHECK(ask(piece(path, 4, "4567")).problem() == "conflict");
  CHECK(ask(piece(path, 8, "89", {kWrongSum})).problem() == "checksum_mismatch");
  CHECK(ask(piece(path, 8, "89", {"Upload-Checksum: md5 AAAA"})).status == 400);
  CHECK(ask(piece(path, 8, "89", {"Content-Encoding: br"})).status == 415);
  CHECK(ask({"PATCH", path, {kVersion, kPieceType}, "89"}).status == 400);
  CHECK(ask(piece(path, 8, std::string(200000, 'x'))).problem() == "too_large");
  limit_files(stage);
  CHECK(ask(piece(path, 8, std::string(150000, 'x'))).problem() == "storage_full");
  Stage stopping;
  see_stop(walk, piece(TusClient(stopping.client()).created(9), 0, ""), stopping);
  see_upload_refusals(walk);
}

void walk_delete_upload(ContractWalk& walk) {
  const Stage stage;
  const Asker ask(walk, stage);
  const TusClient client(stage.client());
  const std::string path = client.created(10);
  CHECK(ask(ask.request(path)).status == 204);
  CHECK(ask(ask.request(path)).status == 404);
  WireRequest posted = ask.request(client.created(10));
  posted.method = "POST";
  posted.headers.emplace_back("X-HTTP-Method-Override: DELETE");
  CHECK(ask(posted).status == 204);
  see_header_examples(walk, stage, ask.request("/v1/uploads/" + kNobody));
  see_upload_refusals(walk);
}

}  // namespace fairway::test
