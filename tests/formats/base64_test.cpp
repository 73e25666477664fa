#include "proto/messages/base64.h"

#include <catch2/catch.hpp>

#include "tests/formats/sample_glb.h"

using namespace fairway;
using fairway::test::text_bytes;

TEST_CASE("base64 of every length comes back") {
  std::string text;
  for (int length = 0; length < 70; ++length) {
    const auto bytes = text_bytes(text);
    const std::string encoded = encode_base64(bytes);
    REQUIRE(encoded.size() % 4 == 0);
    const auto back = decode_base64(encoded);
    REQUIRE(back);
    CHECK(*back == bytes);
    text += static_cast<char>(length * 37);
  }
}

TEST_CASE("base64 agrees with RFC 4648") {
  CHECK(encode_base64(text_bytes("foobar")) == "Zm9vYmFy");
  CHECK(encode_base64(text_bytes("fooba")) == "Zm9vYmE=");
  CHECK(encode_base64(text_bytes("foob")) == "Zm9vYg==");
}

TEST_CASE("base64 decoder refuses what is not strict") {
  for (const char* text : {"Zm9vYg", "Zm9vYg=", "Zm9v Yg==", "Zm9vYh==", "Zm9=YmFy",
                           "====", "Z===", "Zm9vYmF*", "Zm9vYmF\n", "Zm-_"}) {
    CAPTURE(text);
    CHECK_FALSE(decode_base64(text));
  }
}

TEST_CASE("data URI payload is found for base64 only") {
  CHECK(data_uri_payload("data:application/gltf-buffer;base64,AAAA") == "AAAA");
  CHECK(data_uri_payload("DATA:;BASE64,AAAA") == "AAAA");
  CHECK_FALSE(data_uri_payload("data:text/plain,hello"));
  CHECK_FALSE(data_uri_payload("data:;base64"));
  CHECK_FALSE(data_uri_payload("file:///etc/hostname"));
}
