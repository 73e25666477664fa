// Uploads in pieces: the protocol, against the real service.
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "proto/messages/base64.h"
#include "server/fairwayd/commands/tenant_command.h"
#include "server/os/checksum.h"
#include "tests/service/support/job_follower.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"
#include "tests/service/uploads/tus_client.h"

using namespace fairway;
using namespace fairway::test;

namespace {

std::string checksum_header(ChecksumAlgorithm algorithm, const std::string& bytes) {
  Checksum sum(algorithm);
  sum.update(std::as_bytes(std::span(bytes)));
  return (algorithm == ChecksumAlgorithm::sha1 ? "sha1 " : "sha256 ") + encode_base64(sum.finish());
}

std::size_t files_in(const std::filesystem::path& directory) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& each : std::filesystem::directory_iterator(directory)) ++count;
  return count;
}

/// Asks until it is so, and fails the test after a long while.
template <class So>
void wait_until(const So& so) {
  const auto until = std::chrono::steady_clock::now() + kPatience;
  while (!so()) {
    REQUIRE(std::chrono::steady_clock::now() < until);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

std::string make_key(const TemporaryDirectory& directory, const char* tenant) {
  const std::string data = directory.path();
  const auto text =
      run_tenant_command(std::vector<const char*>{"keys", "add", "--tenant", tenant, "--scopes",
                                                  "submit", "--label", "t", "--data", data.c_str()},
                         {});
  REQUIRE(text);
  return text->substr(0, text->find('\n'));
}

}  // namespace

TEST_CASE("OPTIONS tells what of tus is spoken") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(),
                               {"--max-body", "1000", "--cors-origins", "https://app.example"});
  const Answer told = service.client().send(
      "OPTIONS", "/v1/uploads",
      {{"Origin", "https://app.example"}, {"Access-Control-Request-Method", "PATCH"}});
  CHECK(told.status == 204);
  CHECK(told.header("tus-resumable") == "1.0.0");
  CHECK(told.header("tus-version") == "1.0.0");
  CHECK(told.header("tus-extension") ==
        "creation,creation-with-upload,expiration,termination,checksum");
  CHECK(told.header("tus-max-size") == "1000");
  CHECK(told.header("tus-checksum-algorithm") == "sha1,sha256");
  for (const char* name :
       {"Tus-Resumable", "Upload-Length", "Upload-Metadata", "Upload-Offset", "Upload-Checksum"}) {
    CHECK(told.header("access-control-allow-headers").find(name) != std::string::npos);
  }
  const std::string exposed = told.header("access-control-expose-headers");
  for (const char* name : {"Location", "Tus-Resumable", "Upload-Offset", "Upload-Length"}) {
    CHECK(exposed.find(name) != std::string::npos);
  }
  CHECK(service.client().send("OPTIONS", "/v1/jobs").header("tus-version").empty());
}

TEST_CASE("an upload grows piece by piece, and says how far it is") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const TusClient client(service.client());
  const std::string metadata = metadata_pair("filename", "mesh.glb") + ",is_good";
  const Answer made = client.create(10, {{"Upload-Metadata", metadata}});
  REQUIRE(made.status == 201);
  CHECK(made.header("tus-resumable") == "1.0.0");
  CHECK(made.header("upload-expires").ends_with(" GMT"));
  const std::string path = made.header("location");
  CHECK(path.starts_with("/v1/uploads/"));
  CHECK(client.offset(path) == 0);
  const Answer first = client.patch(path, 0, "0123");
  CHECK(first.status == 204);
  CHECK(first.header("upload-offset") == "4");
  CHECK(first.header("upload-expires").ends_with(" GMT"));
  CHECK(client.patch(path, 4, "").header("upload-offset") == "4");
  CHECK(client.patch(path, 4, "456789").header("upload-offset") == "10");
  const Answer there = client.head(path);
  CHECK(there.header("upload-offset") == "10");
  CHECK(there.header("upload-length") == "10");
  CHECK(there.header("upload-metadata") == metadata);
  CHECK(there.header("cache-control") == "no-store");
  std::ifstream file(directory.path() / "uploads" / id_of_upload(path));
  CHECK(std::string(std::istreambuf_iterator<char>(file), {}) == "0123456789");
}

TEST_CASE("an upload may bring its first bytes with it") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient raw = service.client();
  HttpClient::Headers headers = {{"Tus-Resumable", "1.0.0"},
                                 {"Upload-Length", "8"},
                                 {"Content-Type", "application/offset+octet-stream"}};
  const Answer made = raw.send("POST", "/v1/uploads", headers, "0123");
  CHECK(made.status == 201);
  CHECK(made.header("upload-offset") == "4");
  CHECK(TusClient(raw).offset(made.header("location")) == 4);
  // What cannot be taken leaves nothing behind.
  CHECK(raw.send("POST", "/v1/uploads", headers, "012345678").problem() == "too_large");
  headers.emplace("Upload-Checksum", checksum_header(ChecksumAlgorithm::sha256, "other"));
  CHECK(raw.send("POST", "/v1/uploads", headers, "0123").status == 460);
  CHECK(files_in(directory.path() / "uploads") == 1);
  headers.erase("Content-Type");
  headers.emplace("Content-Type", "text/plain");
  CHECK(raw.send("POST", "/v1/uploads", headers, "0123").status == 415);
}

TEST_CASE("requests that tus does not allow are refused, and change nothing") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--max-body", "100"});
  const HttpClient raw = service.client();
  const TusClient client(raw);
  const std::string path = client.created(10);
  REQUIRE(client.patch(path, 0, "0123").status == 204);

  const Answer conflict = client.patch(path, 3, "34");
  CHECK(conflict.status == 409);
  CHECK(conflict.json()["detail"].get<std::string>().find(" 4") != std::string::npos);
  CHECK(client.patch(path, 5, "5").problem() == "conflict");
  CHECK(client.patch(path, 4, "4567890").problem() == "too_large");
  CHECK(client.patch(path, 4, "4", {{"Content-Type", "text/plain"}}).status == 415);
  CHECK(client.patch(path, 4, "4", {{"Upload-Checksum", "md5 AAAA"}}).status == 400);
  const HttpClient::Headers version = {{"Tus-Resumable", "1.0.0"},
                                       {"Content-Type", "application/offset+octet-stream"}};
  CHECK(raw.send("PATCH", path, version, "4").status == 400);
  CHECK(client.offset(path) == 4);

  const Answer old = raw.send("HEAD", path, {{"Tus-Resumable", "0.2.2"}});
  CHECK(old.status == 412);
  CHECK(old.header("tus-version") == "1.0.0");
  CHECK(raw.send("POST", "/v1/uploads", {{"Upload-Length", "1"}}).problem() ==
        "precondition_failed");
  CHECK(raw.send("POST", "/v1/uploads", version).status == 400);
  HttpClient::Headers deferred = version;
  deferred.emplace("Upload-Defer-Length", "1");
  CHECK(raw.send("POST", "/v1/uploads", deferred).status == 400);
  CHECK(client.create(0).status == 400);
  CHECK(client.create(101).problem() == "too_large");
  CHECK(client.create(1, {{"Upload-Metadata", "filename *"}}).status == 400);
  CHECK(client.create(1, {{"Upload-Metadata", "a AAAA,a AAAA"}}).status == 400);
  CHECK(raw.get(path).status == 405);
  const std::string strange = "/v1/uploads/AAAAAAAAAAAAAAAAAAAAAA";
  CHECK(client.head(strange).status == 404);
  CHECK(client.patch(strange, 0, "0").problem() == "not_found");
  CHECK(client.remove(strange).problem() == "not_found");
  CHECK(files_in(directory.path() / "uploads") == 1);
}

TEST_CASE("bytes without a length that outgrow their upload are refused") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const TusClient client(service.client());
  const std::string path = client.created(5);
  const std::string answer = service.client().raw(
      "PATCH " + path +
      " HTTP/1.1\r\nHost: t\r\nTus-Resumable: 1.0.0\r\nUpload-Offset: 0\r\n"
      "Content-Type: application/offset+octet-stream\r\nTransfer-Encoding: chunked\r\n\r\n"
      "6\r\n012345\r\n0\r\n\r\n");
  CHECK(answer.starts_with("HTTP/1.1 413"));
  CHECK(client.offset(path) == 0);
}

TEST_CASE("bytes with a checksum count when it is right, all or none") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const TusClient client(service.client());
  const std::string path = client.created(8);
  const auto sent = [&](std::uint64_t offset, const std::string& bytes, const std::string& sum) {
    return client.patch(path, offset, bytes, {{"Upload-Checksum", sum}});
  };
  CHECK(sent(0, "0123", checksum_header(ChecksumAlgorithm::sha256, "0123")).status == 204);
  const Answer wrong = sent(4, "4567", checksum_header(ChecksumAlgorithm::sha256, "4568"));
  CHECK(wrong.status == 460);
  CHECK(wrong.problem() == "checksum_mismatch");
  CHECK(client.offset(path) == 4);
  // Cut short: nothing can be told of what came.
  std::string head = patch_head(path, 4, 4);
  head.insert(head.size() - 2,
              "Upload-Checksum: " + checksum_header(ChecksumAlgorithm::sha1, "4567") + "\r\n");
  {
    RawConnection broken(service.port());
    broken.send(head + "45");
    broken.close_sending();
    CHECK(broken.read_all().starts_with("HTTP/1.1 400"));
  }
  CHECK(client.offset(path) == 4);
  CHECK(sent(4, "4567", checksum_header(ChecksumAlgorithm::sha1, "4567")).status == 204);
  CHECK(client.offset(path) == 8);
  CHECK(files_in(directory.path() / "spool") == 0);
}

TEST_CASE("what came before a connection broke is kept, and the rest follows") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const TusClient client(service.client());
  const std::string mesh = noisy_torus(40);
  const std::string path = client.created(mesh.size());
  const std::size_t half = mesh.size() / 2;
  {
    RawConnection broken(service.port());
    broken.send(patch_head(path, 0, mesh.size()) + mesh.substr(0, half));
    broken.close_sending();
    CHECK(broken.read_all().starts_with("HTTP/1.1 400"));
  }
  CHECK(client.offset(path) == half);
  CHECK(client.patch(path, half, mesh.substr(half)).status == 204);
  const Answer job = service.client().post("/v1/jobs?upload=" + id_of_upload(path));
  REQUIRE(job.status == 202);
  CHECK(job.json()["input"]["sha256"] == sha256_of(mesh));
}

TEST_CASE("a request with bytes takes over from one whose bytes do not come") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const TusClient client(service.client());
  const std::string path = client.created(10);
  RawConnection first(service.port());
  first.send(patch_head(path, 0, 10) + "01234");
  wait_until([&] { return client.offset(path) == 5; });
  RawConnection second(service.port());
  second.send(patch_head(path, 5, 5) + "5");
  CHECK(first.read_all().starts_with("HTTP/1.1 400"));
  wait_until([&] { return client.offset(path) == 6; });
  // Also where it has to learn first how far the upload is.
  CHECK(client.patch(path, 5, "xxxxx").problem() == "conflict");
  CHECK(second.read_all().starts_with("HTTP/1.1 400"));
  CHECK(client.offset(path) == 6);
  CHECK(client.patch(path, 6, "6789").status == 204);
  std::ifstream file(directory.path() / "uploads" / id_of_upload(path));
  CHECK(std::string(std::istreambuf_iterator<char>(file), {}) == "0123456789");
}

TEST_CASE("an upload that is ended leaves nothing, also while bytes come") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const TusClient client(service.client());
  const std::string path = client.created(10);
  RawConnection sender(service.port());
  sender.send(patch_head(path, 0, 10) + "01234");
  wait_until([&] { return client.offset(path) == 5; });
  CHECK(client.remove(path).status == 204);
  sender.send("56789");
  CHECK(sender.read_until("\r\n\r\n").starts_with("HTTP/1.1 404"));
  CHECK(client.head(path).status == 404);
  CHECK(client.remove(path).status == 404);
  CHECK(files_in(directory.path() / "uploads") == 0);
}

TEST_CASE("an upload that nobody goes on with expires") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--upload-keep", "1"});
  const TusClient client(service.client());
  const std::string path = client.created(10);
  wait_until([&] { return client.head(path).status != 200; });
  const int status = client.head(path).status;
  CHECK((status == 410 || status == 404));
  CHECK((client.patch(path, 0, "0").status == 410 || client.patch(path, 0, "0").status == 404));
  wait_until([&] { return files_in(directory.path() / "uploads") == 0; });
  wait_until([&] { return client.head(path).status == 404; });
}

TEST_CASE("an upload of one tenant is not there for another") {
  const TemporaryDirectory directory;
  const std::string mine = make_key(directory, "mine");
  const std::string theirs = make_key(directory, "theirs");
  const ServiceProcess service(directory.path(), {"--auth", "keys"});
  const TusClient me(service.client(), {{"Authorization", "Bearer " + mine}});
  const TusClient they(service.client(), {{"Authorization", "Bearer " + theirs}});
  const Answer nobody = TusClient(service.client()).create(10);
  CHECK(nobody.status == 401);
  const std::string mesh = small_glb();
  const std::string path = me.upload(mesh);
  CHECK(they.head(path).status == 404);
  CHECK(they.patch(path, 0, "0").status == 404);
  CHECK(they.remove(path).status == 404);
  const std::string job = "/v1/jobs?upload=" + id_of_upload(path);
  CHECK(service.client()
            .post(job, "", "text/plain", {{"Authorization", "Bearer " + theirs}})
            .status == 404);
  CHECK(
      service.client().post(job, "", "text/plain", {{"Authorization", "Bearer " + mine}}).status ==
      202);
}

TEST_CASE("uploads count in the quota at their full length, and are bounded in number") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--quota", "1000"});
  const TusClient client(service.client());
  const std::string path = client.created(900);
  const Answer full = client.create(101);
  CHECK(full.status == 507);
  CHECK(full.problem() == "quota_exceeded");
  CHECK(client.remove(path).status == 204);
  for (int i = 0; i < 100; ++i) client.created(1);
  const Answer many = client.create(1);
  CHECK(many.status == 429);
  CHECK(many.problem() == "rate_limited");
}

TEST_CASE("an upload without a place on the disk is refused before it is sent") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path(), {"--min-free", "281474976710656"});
  CHECK(TusClient(service.client()).create(10).problem() == "storage_full");
}

TEST_CASE("a refusal comes before the bytes where the client waits for it") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const std::string path = TusClient(service.client()).created(10);
  std::string head = patch_head(path, 3, 7);
  head.insert(head.size() - 2, "Expect: 100-continue\r\n");
  CHECK(service.client().raw(head).starts_with("HTTP/1.1 409"));
}

TEST_CASE("a client that cannot send PATCH or DELETE says so in a POST") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const TusClient client(service.client());
  const std::string path = client.created(4);
  HttpClient::Headers headers = {{"Tus-Resumable", "1.0.0"},
                                 {"Upload-Offset", "0"},
                                 {"Content-Type", "application/offset+octet-stream"},
                                 {"X-HTTP-Method-Override", "PATCH"}};
  CHECK(service.client().send("POST", path, headers, "0123").status == 204);
  CHECK(client.offset(path) == 4);
  CHECK(service.client()
            .send("POST", path, {{"Tus-Resumable", "1.0.0"}, {"X-HTTP-Method-Override", "DELETE"}})
            .status == 204);
  CHECK(client.head(path).status == 404);
  CHECK(service.client().send("POST", path, {{"Tus-Resumable", "1.0.0"}}).status == 405);
}
