#include "server/fairwayd/http/http_fields.h"

#include <string>

#include <catch2/catch.hpp>

using namespace fairway;

TEST_CASE("a field is split outside of its quoted strings, without empty elements") {
  using Elements = std::vector<std::string_view>;
  CHECK(split_field("a, b ,,\tc", ',') == Elements{"a", "b", "c"});
  CHECK(split_field(R"(a="x, y", b="\",", c)", ',') == Elements{R"(a="x, y")", R"(b="\",")", "c"});
  CHECK(split_field("", ',').empty());
  CHECK(split_field(" , ,", ',').empty());
  CHECK(split_field(R"(open="x, y)", ',') == Elements{R"(open="x, y)"});
  CHECK(split_field(R"("\)", ',') == Elements{R"("\)"});
}

TEST_CASE("a word has a name in lower case and a value without quotes") {
  const auto text = [](std::string_view from) {
    const auto word = named_word(from);
    return word ? word->name + "|" + word->value : "refused";
  };
  CHECK(text("Wait=10") == "wait|10");
  CHECK(text("respond-ASYNC") == "respond-async|");
  CHECK(text(R"(foo = "a \"b\" c")") == "foo|a \"b\" c");
  CHECK(text("foo=") == "foo|");
  CHECK(text("fo o=1") == "refused");
  CHECK(text("=1") == "refused");
  CHECK(text("foo=a b") == "refused");
  CHECK(text(R"(foo="a)") == "refused");
  CHECK(text(R"(foo="a"b")") == "refused");
  CHECK(text(R"(foo="a\")") == "refused");
}

TEST_CASE("a date is written as HTTP writes it") {
  CHECK(http_date(784'111'777'999) == "Sun, 06 Nov 1994 08:49:37 GMT");
}

TEST_CASE("a number is digits, and the largest where it does not fit") {
  CHECK(digits_value("0") == 0U);
  CHECK(digits_value("0042") == 42U);
  CHECK(digits_value("18446744073709551615") == UINT64_MAX);
  CHECK(digits_value("99999999999999999999999") == UINT64_MAX);
  for (const char* text : {"", "-1", "+1", "1x", " 1", "0x1"}) {
    CAPTURE(text);
    CHECK_FALSE(digits_value(text));
  }
}
