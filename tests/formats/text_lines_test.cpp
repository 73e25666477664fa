#include "proto/formats/text_lines.h"

#include <catch2/catch.hpp>

#include "proto/formats/bytes.h"

using namespace fairway;

TEST_CASE("lines end with LF, CR LF, CR or the text, and a backslash joins two") {
  const auto lines = [](std::string_view text, Continuation continuation = Continuation::none) {
    std::vector<std::string> out;
    LineReader reader(text, continuation);
    while (reader.next()) out.emplace_back(reader.line());
    return out;
  };
  const std::vector<std::string> expected = {"a", "b", "", "c"};
  CHECK(lines("a\nb\n\nc") == expected);
  CHECK(lines("a\r\nb\r\n\r\nc\r\n") == expected);
  CHECK(lines("a\rb\r\rc\r") == expected);
  CHECK(lines("f 1 \\\n2 3\nv", Continuation::backslash) ==
        std::vector<std::string>{"f 1 \\\n2 3", "v"});
  CHECK(words_of("f 1\\\r\n2 3 ") == std::vector<std::string_view>{"f", "1", "2", "3"});
  CHECK(lines("v\\", Continuation::backslash).size() == 1);
}

TEST_CASE("a line beyond the limit is too large, one at the limit is not") {
  const std::string longest(kMostLineBytes, 'x');
  LineReader fits(longest);
  CHECK(fits.next());
  for (const std::string& text : {longest + "x", longest + "\\\ny"}) {
    LineReader reader(text, Continuation::backslash);
    CHECK_FALSE(reader.next());
    REQUIRE(reader.error());
    CHECK(reader.error()->code == ErrorCode::too_large);
  }
}

TEST_CASE("numbers are whole words and finite") {
  CHECK(parse_real("+1.5e1") == 15.0);
  CHECK(parse_real("-.5") == -0.5);
  CHECK(parse_real("1e-999") == 0.0);
  CHECK(parse_real("0." + std::string(400, '0') + "1") == 0.0);
  for (const char* word :
       {"", "+", "-", "nan", "inf", "-inf", "1e999", "1x", "0x10", "+-1", "1,5", "."}) {
    CAPTURE(word);
    CHECK_FALSE(parse_real(word));
  }
  CHECK_FALSE(parse_real("1" + std::string(400, '0')));
  CHECK(parse_integer("-2147483648") == -2147483648LL);
  CHECK_FALSE(parse_integer("9223372036854775808"));
  CHECK(shortest(0.1F) == "0.1");
  CHECK(shortest(0.1) == "0.1");
}
