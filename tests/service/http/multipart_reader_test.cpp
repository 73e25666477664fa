// Forms as they arrive, in pieces of any size.
#include "server/fairwayd/http/multipart_reader.h"

#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace fairway;

namespace {

struct Part {
  PartHead head;
  std::string content;
};

/// Reads a whole body that arrives in pieces of `piece` bytes.
Result<std::vector<Part>> parts_of(const std::string& body, std::size_t piece,
                                   const std::string& boundary = "B") {
  std::size_t at = 0;
  MultipartReader reader(boundary, [&](std::span<char> space) -> Result<std::size_t> {
    const std::size_t count = std::min({space.size(), piece, body.size() - at});
    body.copy(space.data(), count, at);
    at += count;
    return count;
  });
  std::vector<Part> parts;
  const auto read = reader.read(
      [&](const PartHead& head) {
        parts.push_back({head, {}});
        return Result<void>();
      },
      [&](std::span<const std::byte> bytes) {
        parts.back().content.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return Result<void>();
      });
  if (!read) return read.error();
  CHECK(at == body.size());
  return parts;
}

bool is_refused(const std::string& body) {
  const auto parts = parts_of(body, 7);
  if (!parts) CHECK(parts.error().code == ErrorCode::bad_request);
  return !parts;
}

std::string part(const std::string& head, const std::string& content = "x") {
  return "--B\r\n" + head + "\r\n\r\n" + content + "\r\n";
}

const std::string kNamed = "Content-Disposition: form-data; name=\"a\"";
const std::string kEnd = "--B--\r\n";

}  // namespace

TEST_CASE("a form's parts are the same, however its bytes arrive") {
  const std::string content = "\r\n--\r\n--A\r\n\r\n-\r\n--";
  const std::string body =
      part(
          "Content-Disposition: form-data; name=\"mesh\"; filename=\"a b.glb\"\r\n"
          "Content-Type: model/gltf-binary",
          content) +
      part("X-Other: y\r\ncontent-disposition:form-data;name=params", "") + kEnd;
  for (const std::size_t piece : {1U, 2U, 3U, 5U, 64U, 100000U}) {
    CAPTURE(piece);
    const auto parts = parts_of(body, piece);
    REQUIRE(parts);
    REQUIRE(parts->size() == 2);
    CHECK((*parts)[0].head.name == "mesh");
    CHECK((*parts)[0].head.file_name == "a b.glb");
    CHECK((*parts)[0].head.content_type == "model/gltf-binary");
    CHECK((*parts)[0].content == content);
    CHECK((*parts)[1].head.name == "params");
    CHECK((*parts)[1].head.file_name.empty());
    CHECK((*parts)[1].content.empty());
  }
}

TEST_CASE("names in quotes keep what is escaped in them, and nothing else") {
  const auto name_in = [](const std::string& value) {
    const auto parts = parts_of(part("Content-Disposition: form-data; name=" + value) + kEnd, 100);
    return parts && parts->size() == 1 ? parts->front().head.name : "refused";
  };
  CHECK(name_in(R"("a\"b")") == "a\"b");
  CHECK(name_in(R"("a\\")") == "a\\");
  CHECK(name_in(R"("C:\dir\a.glb")") == R"(C:\dir\a.glb)");
  CHECK(name_in(R"("a;b=c")") == "a;b=c");
  CHECK(name_in(R"("a"; other=b; filename*=UTF-8''c)") == "a");
  CHECK(name_in(R"("a)") == "refused");
  CHECK(name_in(R"("a"b)") == "refused");
}

TEST_CASE("the head of a part is bounded in bytes and in lines") {
  CHECK_FALSE(
      is_refused(part(kNamed + "\r\nA: " + std::string(kMaxPartHeadBytes - 200, 'x')) + kEnd));
  CHECK(is_refused(part(kNamed + "\r\nA: " + std::string(kMaxPartHeadBytes, 'x')) + kEnd));
  const std::string half = "\r\nA: " + std::string(kMaxPartHeadBytes / 2, 'x');
  CHECK_FALSE(is_refused(part(kNamed + half) + kEnd));
  CHECK(is_refused(part(kNamed + half + half) + kEnd));
  std::string lines = kNamed;
  for (std::size_t i = 1; i < kMaxPartHeaders; ++i) lines += "\r\nA: b";
  CHECK_FALSE(is_refused(part(lines) + kEnd));
  CHECK(is_refused(part(lines + "\r\nA: b") + kEnd));
}

TEST_CASE("a form that is broken anywhere is refused") {
  const std::string whole = part(kNamed) + kEnd;
  REQUIRE_FALSE(is_refused(whole));
  for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
    CAPTURE(size);
    CHECK(is_refused(whole.substr(0, size)));
  }
  CHECK(is_refused("preamble\r\n" + whole));
  CHECK(is_refused(part("Content-Disposition: attachment; name=\"a\"") + kEnd));
  CHECK(is_refused(part("Content-Type: text/plain") + kEnd));
  CHECK(is_refused(part(kNamed + "\r\n" + kNamed) + kEnd));
  CHECK(is_refused(part("no field") + kEnd));
  CHECK(is_refused("--B \r\n" + whole.substr(5)));
  CHECK_FALSE(is_refused("\r\n" + whole));
  CHECK_FALSE(is_refused(whole + std::string(kMaxEpilogueBytes - 2, 'e')));
  CHECK(is_refused(whole + std::string(kMaxEpilogueBytes, 'e')));
}

TEST_CASE("a boundary is short and of its set of characters") {
  const auto boundary_in = [](const std::string& parameters) {
    return form_boundary("multipart/form-data" + parameters).value_or("none");
  };
  CHECK(boundary_in("; boundary=B") == "B");
  CHECK(boundary_in("; charset=utf-8; Boundary=\"a b:c\"") == "a b:c");
  CHECK(boundary_in(";boundary=" + std::string(70, 'B')) == std::string(70, 'B'));
  for (const std::string& parameters :
       {std::string(), std::string("; boundary"), std::string("; boundary="),
        std::string("; boundary=\"\""), "; boundary=" + std::string(71, 'B'),
        std::string("; boundary=B; boundary=C"), std::string("; boundary={}"),
        std::string("; boundary=\"a \"")}) {
    CAPTURE(parameters);
    CHECK(boundary_in(parameters) == "none");
  }
  CHECK(form_boundary("Multipart/Form-Data; boundary=B"));
  CHECK_FALSE(form_boundary("multipart/mixed; boundary=B"));
  CHECK_FALSE(form_boundary("multipart/form-dataX; boundary=B"));
}

TEST_CASE("what a callback refuses ends the reading") {
  const std::string body = part(kNamed) + kEnd;
  const Error no{ErrorCode::too_large, "No."};
  for (const bool at_head : {true, false}) {
    bool given = false;
    MultipartReader reader("B", [&](std::span<char> space) -> Result<std::size_t> {
      const std::size_t count =
          std::exchange(given, true) ? 0 : body.copy(space.data(), space.size());
      return count;
    });
    const auto read = reader.read(
        [&](const PartHead&) { return at_head ? Result<void>(no) : Result<void>(); },
        [&](std::span<const std::byte>) { return at_head ? Result<void>() : Result<void>(no); });
    REQUIRE_FALSE(read);
    CHECK(read.error().code == ErrorCode::too_large);
  }
}
