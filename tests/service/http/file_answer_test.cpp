#include "server/fairwayd/http/file_answer.h"

#include <fstream>
#include <string>

#include <catch2/catch.hpp>
#include <fcntl.h>

#include "server/os/file.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;

namespace {

const std::string kContent = "0123456789abcdefghij";
const std::string kEmptyDigest = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

class Fixture {
 public:
  Fixture() { std::ofstream(path()) << kContent; }

  HttpResponse answer(NameValues headers, const std::string& method = "GET") const {
    HttpRequest request;
    request.method = method;
    request.headers = std::move(headers);
    auto file = open_file(path().c_str(), O_RDONLY);
    REQUIRE(file);
    return file_answer(request, std::move(*file),
                       {kContent.size(), kEmptyDigest, "model/ply", "a/../b.ply"});
  }
  std::filesystem::path path() const { return directory_.path() / "file"; }

 private:
  test::TemporaryDirectory directory_;
};

std::string header(const HttpResponse& response, std::string_view name) {
  for (const auto& [key, value] : response.headers) {
    if (key == name) return value;
  }
  return "";
}

std::string read_body(HttpResponse response, std::size_t piece = 4096) {
  REQUIRE(response.file);
  const std::uint64_t size = response.file->size();
  FileBodyReader reader(std::move(*response.file));
  std::string text;
  std::string space(piece, '\0');
  while (const std::size_t got = reader.read(space)) text.append(space, 0, got);
  CHECK(text.size() == size);
  return text;
}

std::string range(const Fixture& f, const std::string& value) {
  HttpResponse response = f.answer({{"range", value}});
  CHECK(response.status == 206);
  CHECK(response.content_type == "model/ply");
  const std::string place = header(response, "Content-Range");
  return place + " " + read_body(std::move(response));
}

}  // namespace

TEST_CASE("a file is answered whole with its version, digest and name") {
  const Fixture f;
  HttpResponse response = f.answer({});
  CHECK(response.status == 200);
  CHECK(response.content_type == "model/ply");
  CHECK(header(response, "ETag") == '"' + kEmptyDigest + '"');
  CHECK(header(response, "Repr-Digest") ==
        "sha-256=:47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=:");
  CHECK(header(response, "Accept-Ranges") == "bytes");
  CHECK(header(response, "Cache-Control") == "private, no-transform");
  CHECK(header(response, "Content-Disposition") == R"(attachment; filename="a_.._b.ply")");
  CHECK(header(response, "Content-Range").empty());
  const std::string body = read_body(std::move(response));
  CHECK(body == kContent);
}

TEST_CASE("a range of a file is answered with its place and the digest of the whole") {
  const Fixture f;
  CHECK(range(f, "bytes=0-3") == "bytes 0-3/20 0123");
  CHECK(range(f, "bytes=-2") == "bytes 18-19/20 ij");
  CHECK(range(f, "bytes=10-") == "bytes 10-19/20 abcdefghij");
  CHECK(header(f.answer({{"range", "bytes=0-3"}}), "Repr-Digest") ==
        header(f.answer({}), "Repr-Digest"));
}

TEST_CASE("several ranges are one multipart body, read in pieces of any size") {
  const Fixture f;
  for (const std::size_t piece : {1U, 3U, 4096U}) {
    HttpResponse response = f.answer({{"range", "bytes=0-1,5-7"}});
    CHECK(response.status == 206);
    CHECK(header(response, "Content-Range").empty());
    const std::string kind = "multipart/byteranges; boundary=";
    REQUIRE(response.content_type.starts_with(kind));
    const std::string boundary = "--" + response.content_type.substr(kind.size());
    const std::string head = "\r\nContent-Type: model/ply\r\nContent-Range: bytes ";
    const std::string body = read_body(std::move(response), piece);
    CHECK(body == boundary + head + "0-1/20\r\n\r\n01\r\n" + boundary + head +
                      "5-7/20\r\n\r\n567\r\n" + boundary + "--\r\n");
  }
}

TEST_CASE("a range that is refused says how long the file is") {
  const Fixture f;
  for (const char* value : {"bytes=20-", "bytes=5-6,0-1"}) {
    const HttpResponse response = f.answer({{"range", value}});
    CHECK(response.status == 416);
    CHECK(header(response, "Content-Range") == "bytes */20");
    CHECK_FALSE(response.file);
  }
}

TEST_CASE("a range counts for GET only, once, and for the version that If-Range names") {
  const Fixture f;
  const std::string tag = '"' + kEmptyDigest + '"';
  CHECK(f.answer({{"range", "bytes=0-1"}, {"if-range", tag}}).status == 206);
  CHECK(f.answer({{"range", "bytes=0-1"}, {"if-range", "\"x\""}}).status == 200);
  CHECK(f.answer({{"range", "bytes=99-"}, {"if-range", "\"x\""}}).status == 200);
  CHECK(f.answer({{"range", "bytes=0-1"}, {"range", "bytes=2-3"}}).status == 200);
  CHECK(f.answer({{"range", "bytes=0-1"}}, "HEAD").status == 200);
  CHECK(f.answer({{"range", "bytes=0-1"}}, "POST").status == 200);
  CHECK(f.answer({{"range", "lines=0-1"}}).status == 200);
}

TEST_CASE("preconditions come before ranges") {
  const Fixture f;
  const std::string tag = '"' + kEmptyDigest + '"';
  const HttpResponse same = f.answer({{"if-none-match", tag}, {"range", "bytes=99-"}});
  CHECK(same.status == 304);
  CHECK(header(same, "ETag") == tag);
  CHECK_FALSE(same.file);
  CHECK(f.answer({{"if-match", "\"x\""}, {"range", "bytes=0-1"}}).status == 412);
  CHECK(f.answer({{"if-none-match", tag}}, "POST").status == 200);
}

TEST_CASE("a file that is shorter than was said ends its body") {
  const Fixture f;
  HttpResponse response = f.answer({});
  std::filesystem::resize_file(f.path(), 5);
  FileBodyReader reader(std::move(*response.file));
  std::string space(100, '\0');
  CHECK(reader.read(space) == 5);
  CHECK(reader.read(space) == 0);
}

TEST_CASE("a file name that a client saves under is harmless") {
  CHECK(safe_file_name("mesh-1_a.glb") == "mesh-1_a.glb");
  CHECK(safe_file_name(".profile") == "_profile");
  CHECK(safe_file_name("a/b\\c\"d\r\n;\xC3\xA9") == "a_b_c_d_____");
}
