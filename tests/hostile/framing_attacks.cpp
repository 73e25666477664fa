// One client that keeps to no rule about where its request ends.
#include <array>
#include <chrono>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "tests/hostile/attacks.h"

namespace fairway::hostile {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// More than any limit: who takes it all has none.
constexpr std::size_t kEndless = 8 * kBodyLimit;

/// Sends `piece` over and over until the server closes. Returns the bytes it took.
std::size_t pour(Wire& wire, const std::string& piece, std::size_t most = kEndless) {
  std::size_t sent = 0;
  while (sent < most && !wire.is_closed() && answers_in(wire.received()).whole.empty()) {
    const std::size_t now = wire.send(piece, kPatience);
    if (now == 0) break;
    sent += now;
  }
  return sent;
}

/// Many copies of one short text.
std::string times(std::size_t count, const std::string& text) {
  std::string all;
  all.reserve(count * text.size());
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

void expect_poured(const Field& field, const std::string& head, const std::string& piece,
                   std::size_t most, const std::string& statuses) {
  Wire wire(field.port());
  wire.send(head, kPatience);
  const std::size_t sent = pour(wire, piece);
  expect(sent <= most, fmt::format("{} bytes were taken", sent));
  field.expect_refused(wire, statuses);
}

void chunked_flood(Field& field) {
  const std::string chunked = upload_head({"Transfer-Encoding: chunked"});
  // The beginning of a GLB of 16 MiB, so that nothing else is wrong.
  const std::string glb = chunked + std::string("c\r\nglTF\2\0\0\0\0\0\0\1\r\n", 17);
  const std::string chunk = "10000\r\n" + std::string(65536, 'x') + "\r\n";
  expect_poured(field, glb, chunk, 2 * kBodyLimit, "413");
  // Chunks that are all frame.
  const std::string crumb = "1;" + std::string(200, 'e') + "\r\nx\r\n";
  expect_poured(field, glb, times(300, crumb), kBodyLimit, "400");
  expect_poured(field, chunked + "0\r\n", times(1000, "Trailer: of no end\r\n"), kBodyLimit, "400");
  expect_poured(field, chunked, std::string(65536, '0'), kBodyLimit, "400");
}

void gzip_bomb(Field& field) {
  const std::string zeros(100000, '\0');
  for (const char* coding :
       {"gzip", "x-gzip", "deflate", "br", "zstd", "gzip, gzip", "identity, gzip"}) {
    field.expect_refused(upload_head({fmt::format("Content-Encoding: {}", coding),
                                      fmt::format("Content-Length: {}", zeros.size())}),
                         zeros, "415");
  }
  field.expect_refused(upload_head({"Transfer-Encoding: gzip, chunked"}), "0\r\n\r\n", "400|501");
  field.expect_refused(upload_head({"Transfer-Encoding: gzip"}), zeros, "400|501");
}

void endless_body(Field& field) {
  expect_poured(field, upload_head({}), std::string(65536, 'x'), kBodyLimit, "411|400");
  expect_poured(field, upload_head({"Content-Length: 99999999"}), std::string(65536, 'x'),
                kBodyLimit, "413");
}

void range_flood(Field& field) {
  const std::string result = field.large_result();
  std::string ranges = "Range: bytes=0-";
  for (int i = 0; i < 300; ++i) ranges += ",0-";
  for (int i = 0; i < 16; ++i) {
    Wire wire(field.port());
    wire.send(head_of("GET", result, {ranges, "Connection: close"}), kPatience);
    wire.read_until_closed(kPatience);
    expect(wire.received().starts_with("HTTP/1.1 416 "), "300 overlapping ranges are not refused");
    expect(wire.received().size() < 4096, "much is sent for 300 ranges");
  }
}

void header_flood(Field& field) {
  const std::string headers = times(200000, "A: b\r\n");
  for (int i = 0; i < 8; ++i) {
    Wire wire(field.port());
    wire.send(head_of("GET", "/livez").substr(0, 30) + headers + "\r\n", kPatience);
    field.expect_refused(wire, "431|400");
  }
  Wire wire(field.port());
  wire.send("GET /livez HTTP/1.1\r\nHost: t\r\n" + times(101, "A: b\r\n") + "\r\n", kPatience);
  field.expect_refused(wire, "431");
}

void header_line(Field& field) {
  const std::string line(std::size_t{32} << 20, 'h');
  field.expect_refused("GET /livez HTTP/1.1\r\nHost: t\r\nX: ", line + "\r\n\r\n", "431|400");
  field.expect_refused("GET /", line + " HTTP/1.1\r\n\r\n", "414|400");
  field.expect_refused(line, "\r\n\r\n", "414|400");
}

void huge_length(Field& field) {
  for (const char* length : {"1000000000000000000", "18446744073709551615", "18446744073709551616",
                             "99999999999999999999999999999999"}) {
    const auto began = steady_clock::now();
    field.expect_refused(upload_head({fmt::format("Content-Length: {}", length)}), "", "413");
    expect(milliseconds_since(began) < 3000.0 * field.patience(), "the refusal waits for the body");
  }
}

void smuggling(Field& field) {
  const std::string second = "GET /livez HTTP/1.1\r\nHost: t\r\n\r\n";
  constexpr std::array<std::pair<const char*, const char*>, 9> kBoth = {{
      {"Content-Length: 5", "Transfer-Encoding: chunked"},
      {"Transfer-Encoding: chunked", "Content-Length: 0"},
      {"Transfer-Encoding: chunked", "Transfer-Encoding: chunked"},
      {"Transfer-Encoding: chunked", "Transfer-Encoding: identity"},
      {"Transfer-Encoding: xchunked", "A: b"},
      {"Content-Length: 5", "Content-Length: 5"},
      {"Content-Length: 5", "Content-Length: 6"},
      {"Content-Length: 5, 5", "A: b"},
      {"Content-Length: 0x5", "A: b"},
  }};
  for (const auto& [one, other] : kBoth) {
    field.expect_refused(upload_head({one, other}), "0\r\n\r\n" + second, "400");
  }
  for (const char* line : {"Content-Length : 5", " Content-Length: 5", "A: b\nContent-Length: 5",
                           "A: b\rContent-Length: 5", "Content-Length: \v5", ": 5", "A"}) {
    field.expect_refused(upload_head({line}), "01234" + second, "400");
  }
}

void pipelined_flood(Field& field) {
  Wire wire(field.port());
  const std::string requests = times(1000, "GET /livez HTTP/1.1\r\nHost: t\r\n\r\n");
  const auto until = steady_clock::now() + milliseconds(3000);
  std::size_t sent = 0;
  // It never reads: the server takes requests until its own answers find no room.
  while (steady_clock::now() < until && !wire.is_closed()) {
    const std::size_t now = wire.send_some(requests);
    if (now == 0) std::this_thread::sleep_for(milliseconds(5));
    sent += now;
  }
  expect(sent < kBodyLimit, fmt::format("{} bytes of requests were taken", sent));
}

void no_http(Field& field) {
  const std::string hello("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03 and what follows", 33);
  const std::string h2 = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
  for (const std::string& bytes :
       {hello, h2, std::string(100, '\0'), std::string("\x80\x80\x80")}) {
    const auto began = steady_clock::now();
    field.expect_refused(bytes, "", "400");
    expect(milliseconds_since(began) < 3000.0 * field.patience(), "it waits for more of no HTTP");
  }
  Wire wire(field.port());
  const std::size_t sent = pour(wire, times(30000, "\r\n"), kBodyLimit);
  expect(sent < kBodyLimit, "empty lines are taken without end");
  field.expect_refused(wire, "400");
}

void continue_abuse(Field& field) {
  const std::string expects = "Expect: 100-continue";
  // Refused before the body: the client is not told to go on.
  Wire refused(field.port());
  refused.send(upload_head({expects, "Content-Length: 999999999"}), kPatience);
  field.expect_refused(refused, "413");
  expect(refused.received().find("100 Continue") == std::string::npos,
         "told to go on, and refused");
  field.expect_refused(upload_head({"Expect: a-miracle", "Content-Length: 5"}), "01234", "400|417");
  // Many that are told to go on and never do.
  std::vector<Wire> silent;
  for (int i = 0; i < 200; ++i) {
    silent.emplace_back(field.port());
    silent.back().send(upload_head({expects, "Content-Length: 1000"}), kPatience);
  }
  field.expect_serving();
}

void long_target(Field& field) {
  const std::string id(7900, 'a');
  for (const char* method : {"PUT", "POST", "PATCH", "GET"}) {
    const auto began = steady_clock::now();
    Wire wire(field.port());
    wire.send(head_of(method, "/v1/jobs/" + id, {"Content-Length: 1", "Connection: close"}) + "x",
              kPatience);
    field.expect_refused(wire, "400|404|405|414|422");
    expect(milliseconds_since(began) < 3000.0 * field.patience(), "a long target takes long");
  }
}

}  // namespace

std::span<const Attack> framing_attacks() {
  static constexpr std::array kRows = {
      Attack{"chunked-flood", "never-ending chunks, crumbs, trailers and sizes", chunked_flood},
      Attack{"gzip-bomb", "bodies in codings that inflate", gzip_bomb},
      Attack{"endless-body", "a body without a length, and one beyond its limit", endless_body},
      Attack{"range-flood", "300 overlapping ranges of a result", range_flood},
      Attack{"header-flood", "200000 headers", header_flood},
      Attack{"header-line", "header and request lines of 32 MiB", header_line},
      Attack{"huge-length", "Content-Lengths of 1e18 and beyond 64 bits", huge_length},
      Attack{"smuggling", "two framings at once, and lengths that others read otherwise",
             smuggling},
      Attack{"pipelined-flood", "requests without end from one that never reads", pipelined_flood},
      Attack{"no-http", "a TLS client, HTTP/2, noise and empty lines on the plain port", no_http},
      Attack{"continue-abuse", "200 that ask before they send, and never send", continue_abuse},
      Attack{"long-target", "targets of 7900 characters", long_target}};
  return kRows;
}

}  // namespace fairway::hostile
