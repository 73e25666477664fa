// The problem table.

#include "proto/messages/problem.h"

#include <set>

#include <catch2/catch.hpp>

namespace fairway::test {

TEST_CASE("every error code has its own slug, a 4xx or 5xx status and an exit code from 1 to 119") {
  std::set<std::string_view> slugs;
  std::set<int> exit_codes;
  for (int i = 0; i <= static_cast<int>(ErrorCode::internal); ++i) {
    const ProblemKind& kind = problem_kind(static_cast<ErrorCode>(i));
    CHECK(kind.status >= 400);
    CHECK(kind.status <= 507);
    CHECK(kind.exit_code >= 1);
    CHECK(kind.exit_code <= 119);
    CHECK(slugs.insert(kind.slug).second);
    CHECK(exit_codes.insert(kind.exit_code).second);
    CHECK(error_code_of_slug(kind.slug) == kind.code);
  }
}

TEST_CASE("a problem document reads back as the error it was made of") {
  const Error error{ErrorCode::invalid_mesh, "Index 9 of 8 vertices; export the mesh again.",
                    "/accessors/1"};
  const Json problem = problem_document(error);
  CHECK(problem["type"] == "urn:fairway:problem:invalid_mesh");
  CHECK(problem["status"] == 422);
  const Error back = error_of_problem(problem);
  CHECK(back.code == error.code);
  CHECK(back.message == error.message);
  CHECK(back.pointer == error.pointer);
}

}  // namespace fairway::test
