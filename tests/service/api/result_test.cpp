// How the result of a job leaves the service.
#include <string>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/service/support/job_follower.h"
#include "tests/service/support/raw_connection.h"
#include "tests/service/support/sample_glb.h"
#include "tests/service/support/service_process.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;
using namespace fairway::test;

namespace {

/// A service with one job that has succeeded.
class Fixture {
 public:
  Fixture() : job_path_(submit(client(), small_glb())) {
    job_ = wait_until_final(client(), job_path_);
    REQUIRE(job_["state"] == "succeeded");
  }

  HttpClient client() const { return service_.client(); }
  std::uint16_t port() const { return service_.port(); }
  std::string path() const { return job_path_ + "/result"; }
  Answer get(const HttpClient::Headers& headers = {}) const {
    return client().get(path(), headers);
  }
  const Json& job() const { return job_; }
  std::string tag() const { return '"' + job_["result"]["sha256"].get<std::string>() + '"'; }

 private:
  TemporaryDirectory directory_;
  ServiceProcess service_{directory_.path()};
  std::string job_path_;
  Json job_;
};

}  // namespace

TEST_CASE("a result says what it is, and HEAD says the same") {
  const Fixture f;
  const Answer result = f.get();
  const Answer head = f.client().head(f.path());
  for (const Answer& answer : {result, head}) {
    CHECK(answer.status == 200);
    CHECK(answer.header("etag") == f.tag());
    CHECK(answer.header("accept-ranges") == "bytes");
    CHECK(answer.header("cache-control") == "private, no-transform");
    CHECK(answer.header("content-length") == std::to_string(f.job()["result"]["bytes"].get<int>()));
    CHECK(answer.header("content-disposition") ==
          fmt::format("attachment; filename=\"{}.glb\"", f.job()["id"].get<std::string>()));
    CHECK(answer.header("repr-digest").starts_with("sha-256=:"));
  }
  CHECK(head.body.empty());
  CHECK(result.body.size() == f.job()["result"]["bytes"]);
  CHECK(f.client().head("/livez").header("accept-ranges").empty());
}

TEST_CASE("the ranges of a result are its bytes") {
  const Fixture f;
  const std::string whole = f.get().body;
  std::string joined;
  for (std::size_t at = 0; at < whole.size(); at += 400) {
    const Answer part = f.get({{"Range", fmt::format("bytes={}-{}", at, at + 399)}});
    REQUIRE(part.status == 206);
    CHECK(part.header("content-range").ends_with(fmt::format("/{}", whole.size())));
    joined += part.body;
  }
  CHECK((joined == whole));
  const Answer several = f.get({{"Range", "bytes=0-3,8-11"}});
  CHECK(several.status == 206);
  CHECK(several.header("content-type").starts_with("multipart/byteranges; boundary="));
  CHECK(several.header("content-length") == std::to_string(several.body.size()));
  CHECK(several.body.find("\r\n\r\n" + whole.substr(0, 4) + "\r\n--") != std::string::npos);
  CHECK(several.body.find("\r\n\r\n" + whole.substr(8, 4) + "\r\n--") != std::string::npos);
  const Answer beyond = f.get({{"Range", "bytes=999999-"}});
  CHECK(beyond.problem() == "range_not_satisfiable");
  CHECK(beyond.header("content-range") == fmt::format("bytes */{}", whole.size()));
}

TEST_CASE("a result that the client has is not sent again, and the connection goes on") {
  const Fixture f;
  CHECK(f.get({{"If-None-Match", "\"x\", " + f.tag()}}).status == 304);
  CHECK(f.get({{"If-None-Match", "\"x\""}}).status == 200);
  CHECK(f.get({{"If-Match", "\"x\""}}).problem() == "precondition_failed");
  CHECK(f.get({{"Range", "bytes=0-3"}, {"If-Range", f.tag()}}).status == 206);
  CHECK(f.get({{"Range", "bytes=0-3"}, {"If-Range", "\"x\""}}).status == 200);

  RawConnection connection(f.port());
  const auto request = [&](const std::string& headers) {
    return fmt::format("GET {} HTTP/1.1\r\nHost: t\r\n{}\r\n", f.path(), headers);
  };
  connection.send(request("If-None-Match: " + f.tag() + "\r\n") + request("Range: bytes=0-3\r\n") +
                  "GET /livez HTTP/1.1\r\nHost: t\r\n\r\n");
  const std::string same = connection.read_until("\r\n\r\n");
  CHECK(same.starts_with("HTTP/1.1 304 "));
  CHECK(same.find("ETag: " + f.tag()) != std::string::npos);
  CHECK(same.find("Content-Length") == std::string::npos);
  CHECK(same.find("Content-Type") == std::string::npos);
  CHECK(connection.read_until("\r\n\r\n").starts_with("HTTP/1.1 206 "));
  CHECK(connection.read_until("glTF") == "glTF");
  CHECK(connection.read_until("\r\n\r\n").starts_with("HTTP/1.1 200 "));
}

TEST_CASE("a result whose format the client excludes is not sent") {
  const Fixture f;
  CHECK(f.get({{"Accept", "*/*"}}).status == 200);
  CHECK(f.get({{"Accept", "model/*;q=0.1, text/html"}}).status == 200);
  const Answer refused = f.get({{"Accept", "model/ply, model/gltf-binary;q=0"}});
  CHECK(refused.status == 406);
  CHECK(refused.problem() == "not_acceptable");
  CHECK(refused.json()["detail"].get<std::string>().find("model/gltf-binary") != std::string::npos);
  CHECK(f.get({{"Accept", "model/ply"}, {"If-None-Match", f.tag()}}).status == 406);
}

TEST_CASE("Accept chooses the format of a synchronous answer where the parameters do not") {
  const TemporaryDirectory directory;
  const ServiceProcess service(directory.path());
  const HttpClient client = service.client();
  const auto denoise = [&](const std::string& accept, const std::string& query = "") {
    return client.post("/v1/denoise" + query, small_glb(), "model/gltf-binary",
                       {{"Accept", accept}});
  };
  const Answer ply = denoise("model/stl;q=0.2, model/ply;q=0.9");
  CHECK(ply.status == 200);
  CHECK(ply.header("content-type") == "model/ply");
  CHECK(ply.body.starts_with("ply"));
  CHECK(denoise("model/ply, */*;q=0.1").header("content-type") == "model/gltf-binary");

  const auto jobs = [&] { return client.get("/v1/jobs").json()["jobs"].size(); };
  const std::size_t before = jobs();
  const std::string stl = "?params=" + percent_encoded(R"({"output":"stl"})");
  CHECK(denoise("model/ply", stl).problem() == "not_acceptable");
  CHECK(denoise("image/png").problem() == "not_acceptable");
  CHECK(denoise("application/octet-stream").problem() == "not_acceptable");
  CHECK(jobs() == before);
}
