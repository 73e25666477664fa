// Forms that cost more to read than to send.
#include <array>
#include <chrono>
#include <string>

#include <fmt/format.h>

#include "tests/hostile/attacks.h"

namespace fairway::hostile {
namespace {

using std::chrono::steady_clock;

/// Reading what one client sends must not take a processor for longer.
constexpr double kReadBound = 5000.0;

std::string form_head(std::size_t length, const std::string& boundary = "B") {
  return head_of("POST", "/v1/jobs",
                 {"Content-Type: multipart/form-data; boundary=" + boundary,
                  fmt::format("Content-Length: {}", length)});
}

/// Sends a form and expects its refusal, soon.
void expect_form_refused(const Field& field, const std::string& body, const std::string& statuses,
                         const std::string& boundary = "B") {
  const auto began = steady_clock::now();
  field.expect_refused(form_head(body.size(), boundary), body, statuses);
  const double took = milliseconds_since(began);
  expect(took < kReadBound * field.patience(), fmt::format("refused after {:.0f} ms", took));
}

std::string part(const std::string& head, const std::string& content = "x") {
  return "--B\r\n" + head + "\r\n\r\n" + content + "\r\n";
}

std::string named(const std::string& name) {
  return "Content-Disposition: form-data; name=\"" + name + "\"";
}

std::string times(std::size_t count, const std::string& text) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

void many_parts(Field& field) {
  std::string body;
  for (int i = 0; i < 1000; ++i) body += part(named(fmt::format("p{}", i)));
  expect_form_refused(field, body + "--B--\r\n", "400");
  // Parts without a name or content, as many as fit.
  expect_form_refused(field, times(300000, "--B\r\n\r\n\r\n"), "400");
}

void part_heads(Field& field) {
  // Lines that a backtracking matcher tries in quadratically many ways, as many as fit.
  const std::string quotes =
      "Content-Disposition: form-data; name=\"" + times(660, "\";filename=\"") + "x\r\n";
  expect_form_refused(field, "--B\r\n" + times(1900, quotes) + "\r\nx\r\n--B--\r\n", "400");
  expect_form_refused(field, "--B\r\n" + times(1000000, "A: b\r\n") + "\r\nx\r\n--B--\r\n", "400");
  expect_form_refused(field, "--B\r\nA: " + std::string(kBodyLimit / 2, 'x'), "400");
  expect_form_refused(field, part(named("a") + "\r\n" + named("b")) + "--B--\r\n", "400");
  expect_form_refused(field, part(named(std::string(8000, 'n'))) + "--B--\r\n", "400");
  for (const char* head :
       {"Content-Disposition: form-data; name=\"a", "Content-Disposition", ": b",
        "Content-Disposition: attachment; name=\"a\"", "Content-Disposition: form-data; =\"a\"",
        "Content-Disposition: form-data; name=\"a\" filename=\"b\""}) {
    expect_form_refused(field, part(head) + "--B--\r\n", "400");
  }
}

void endless_boundary(Field& field) {
  const std::string head = "--B\r\n" + named("mesh") + "\r\n\r\n";
  // A content that is nothing but beginnings of its end.
  expect_form_refused(field, head + times(kBodyLimit / 4 - 100, "\r\n--"), "400|415");
  const std::string longest(70, '-');
  expect_form_refused(field,
                      "--" + longest + "\r\n" + named("mesh") + "\r\n\r\n" +
                          times(200000, "\r\n--" + longest.substr(1) + "x"),
                      "400|415", longest);
  expect_form_refused(field, std::string(kBodyLimit / 2, '-'), "400");
  expect_form_refused(field, part(named("mesh")) + "--B--" + std::string(kBodyLimit / 2, 'e'),
                      "400");
  for (const std::string& boundary :
       {std::string(71, 'B'), std::string(7000, 'B'), std::string("B\tC"), std::string("\"\""),
        std::string("B; boundary=C"), std::string("{}")}) {
    expect_form_refused(field, part(named("mesh")) + "--B--\r\n", "400", boundary);
  }
}

void two_readings(Field& field) {
  // What another reader may take for the mesh.
  for (const std::string& body :
       {part(named("mesh")) + part(named("mesh")) + "--B--\r\n",
        part(named("mesh") + "; filename=\"a\r\nb\"") + "--B--\r\n",
        part(named("a\tb")) + "--B--\r\n", part(named(std::string("a\0b", 3))) + "--B--\r\n",
        part(named("\xFF\xFE")) + "--B--\r\n", std::string("--B--\r\n"), std::string("--B"),
        part(named("mesh")), "preamble\r\n" + part(named("mesh")) + "--B--\r\n"}) {
    expect_form_refused(field, body, "400|415");
  }
}

}  // namespace

std::span<const Attack> form_attacks() {
  static constexpr std::array kRows = {
      Attack{"many-parts", "forms of 1000 and of 300000 parts", many_parts},
      Attack{"part-heads", "parts whose heads do not end, or take long to match", part_heads},
      Attack{"endless-boundary", "contents that are all boundary, and boundaries without measure",
             endless_boundary},
      Attack{"two-readings", "forms that others read otherwise", two_readings}};
  return kRows;
}

}  // namespace fairway::hostile
