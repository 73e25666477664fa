#include "server/fairwayd/http/http_conditions.h"

#include <string>

#include <catch2/catch.hpp>

using namespace fairway;

namespace {

Condition of(NameValues headers, const EntityTag& current = {"abc", false},
             const std::string& method = "GET") {
  HttpRequest request;
  request.method = method;
  request.headers = std::move(headers);
  return evaluate_conditions(request, current);
}

bool ranges_apply(const std::string& if_range, const EntityTag& current = {"abc", false}) {
  HttpRequest request;
  request.headers = {{"if-range", if_range}};
  return may_apply_range(request, current);
}

const EntityTag kWeak{"abc", true};

}  // namespace

TEST_CASE("If-None-Match names the current version, weakly compared") {
  CHECK(of({{"if-none-match", R"("abc")"}}) == Condition::not_modified);
  CHECK(of({{"if-none-match", R"(W/"abc")"}}) == Condition::not_modified);
  CHECK(of({{"if-none-match", R"("abc")"}}, kWeak) == Condition::not_modified);
  CHECK(of({{"if-none-match", R"("x, y" , W/"abc")"}}) == Condition::not_modified);
  CHECK(of({{"if-none-match", R"("x")"}, {"if-none-match", R"("abc")"}}) ==
        Condition::not_modified);
  CHECK(of({{"if-none-match", "*"}}) == Condition::not_modified);
  for (const char* value :
       {R"("x")", "abc", R"("abc)", R"(w/"abc")", "", R"("ab\c")", R"("ABC")"}) {
    CAPTURE(value);
    CHECK(of({{"if-none-match", value}}) == Condition::proceed);
  }
}

TEST_CASE("If-Match fails unless it names the current version, strongly compared") {
  CHECK(of({{"if-match", R"("x", "abc")"}}) == Condition::proceed);
  CHECK(of({{"if-match", "*"}}) == Condition::proceed);
  CHECK(of({{"if-match", R"("x")"}}) == Condition::failed);
  CHECK(of({{"if-match", R"(W/"abc")"}}) == Condition::failed);
  CHECK(of({{"if-match", R"(W/"abc")"}}, kWeak) == Condition::failed);
  CHECK(of({{"if-match", ""}}) == Condition::failed);
  CHECK(of({{"if-match", R"("x")"}, {"if-none-match", R"("abc")"}}) == Condition::failed);
  CHECK(of({{"if-match", R"("x")"}}, {"abc", false}, "POST") == Condition::proceed);
}

TEST_CASE("a range applies to the version that If-Range names, strongly compared") {
  CHECK(ranges_apply(R"( "abc" )"));
  CHECK_FALSE(ranges_apply(R"("x")"));
  CHECK_FALSE(ranges_apply(R"(W/"abc")"));
  CHECK_FALSE(ranges_apply(R"("abc")", kWeak));
  CHECK_FALSE(ranges_apply(R"("abc", "x")"));
  CHECK_FALSE(ranges_apply("Wed, 21 Oct 2015 07:28:00 GMT"));
  CHECK(may_apply_range(HttpRequest(), {"abc", false}));
}

TEST_CASE("an entity tag is written in quotes") {
  CHECK(to_string(EntityTag{"abc", false}) == R"("abc")");
  CHECK(to_string(kWeak) == R"(W/"abc")");
}
