// How to be refused for want of a key, or for asking too much.

#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "server/fairwayd/commands/tenant_command.h"
#include "server/fairwayd/store/access.h"
#include "tests/service/contract/contract_walks.h"
#include "tests/service/support/sample_glb.h"

namespace fairway::test {
namespace {

/// The text of a new key for the service.
std::string new_key(const Stage& stage, std::string_view scope) {
  const std::string data = stage.directory.path();
  const std::string scopes(scope);
  const std::vector<const char*> words = {"keys",     "add",          "--tenant", "walker",
                                          "--scopes", scopes.c_str(), "--data",   data.c_str()};
  const auto text = run_tenant_command(words, {});
  REQUIRE(text);
  return text->substr(0, text->find('\n'));
}

}  // namespace

void see_keys_asked_for(ContractWalk& walk) {
  const Operation& operation = walk.operation();
  const Stage stage({"--auth", "keys"});
  const std::string path = path_with(operation, kNobody);
  const Answer anonymous = ask(walk, stage, path);
  walk.see(anonymous);
  CHECK((anonymous.status == 401) == !operation.scope.empty());
  if (operation.scope.empty()) return;
  for (const Scope scope : kScopes) {
    const Answer answer =
        ask(walk, stage, path, {"Authorization: Bearer " + new_key(stage, name_of(scope))});
    walk.see(answer);
    const bool fits = scope == Scope::admin || name_of(scope) == operation.scope;
    CAPTURE(name_of(scope), answer.status);
    CHECK(answer.status != 401);
    CHECK((answer.status != 403) == fits);
  }
}

void see_strange_pages(ContractWalk& walk, const Stage& stage) {
  const std::string path = path_with(walk.operation(), kNobody);
  const Answer answer = ask(walk, stage, path, {"Origin: https://strange.example"});
  walk.see(answer);
  const std::set<std::string> safe = {"GET", "HEAD", "OPTIONS"};
  CHECK((answer.status == 403) == !safe.contains(walk.operation().method));
}

void see_rate(ContractWalk& walk) {
  const Stage stage({"--rate", "1"});
  const Answer first = stage.ask(upload(walk, small_glb()));
  walk.see(first);
  CHECK(first.status < 300);
  CHECK_FALSE(first.header("ratelimit").empty());
  CHECK_FALSE(first.header("ratelimit-policy").empty());
  const Answer second = stage.ask(upload(walk, small_glb()));
  walk.see(second);
  CHECK(second.problem() == "rate_limited");
}

void see_shares(ContractWalk& walk) {
  const Stage small({"--quota", "100"});
  const Answer kept = small.ask(upload(walk, noisy_torus(10)));
  walk.see(kept);
  CHECK(kept.problem() == "quota_exceeded");
  const Stage narrow({"--worker-memory", "1000"});
  const Answer held = narrow.ask(upload(walk, noisy_torus(10)));
  walk.see(held);
  CHECK(held.problem() == "too_large");
}

}  // namespace fairway::test
