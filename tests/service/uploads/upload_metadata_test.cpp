#include "server/fairwayd/uploads/upload_metadata.h"

#include <catch2/catch.hpp>

using namespace fairway;

TEST_CASE("the name and type of a file are found in the metadata of its upload") {
  const auto read =
      parse_upload_metadata("filename bWVzaC5wbHk=, filetype  bW9kZWwvcGx5,other,x eA==");
  REQUIRE(read);
  CHECK(read->file_name == "mesh.ply");
  CHECK(read->file_type == "model/ply");
  CHECK(parse_upload_metadata("")->file_name.empty());
  CHECK(parse_upload_metadata("filename")->file_name.empty());
}

TEST_CASE("metadata that cannot be read is refused") {
  for (const char* text : {"filename a", "filename *", "a,a", "filename bWVzaC5wbHk= x"}) {
    CAPTURE(text);
    const auto read = parse_upload_metadata(text);
    REQUIRE_FALSE(read);
    CHECK(read.error().code == ErrorCode::bad_request);
  }
}

TEST_CASE("a checksum has an algorithm that is known and a digest of its length") {
  const auto sha1 = parse_upload_checksum("sha1 qZk+NkcGgWq6PiVxeFDCbJzQ2J0=");
  REQUIRE(sha1);
  CHECK(sha1->algorithm == ChecksumAlgorithm::sha1);
  Checksum sum(ChecksumAlgorithm::sha1);
  sum.update(std::as_bytes(std::span("abc", 3)));
  CHECK(sum.finish() == sha1->digest);
  for (const char* text : {"", "sha1", "md5 qZk+NkcGgWq6PiVxeFDCbJzQ2J0=", "sha256 AAAA",
                           "sha256 qZk+NkcGgWq6PiVxeFDCbJzQ2J0=", "sha1 *"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_upload_checksum(text));
  }
}
