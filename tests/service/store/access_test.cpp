// Keys and their scopes, as texts and as they are kept.
#include "server/fairwayd/store/access.h"

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "server/fairwayd/api/gate.h"
#include "server/fairwayd/store/sqlite_job_store.h"
#include "server/fairwayd/store/sqlite_tenant_store.h"
#include "server/fairwayd/telemetry/clocks.h"
#include "tests/service/support/temporary_directory.h"

using namespace fairway;

namespace {

Scopes scopes(std::string_view text) {
  const auto parsed = parse_scopes(text);
  REQUIRE(parsed);
  return *parsed;
}

class Fixture {
 public:
  Fixture() {
    auto opened = SqliteTenantStore::open(path());
    REQUIRE(opened);
    store_ = std::move(*opened);
  }
  std::filesystem::path path() const { return directory_.path() / "jobs.sqlite"; }
  SqliteTenantStore& store() { return *store_; }

  std::string key(const std::string& tenant, std::string_view allowed,
                  std::optional<UnixMillis> expires = {}) {
    const auto text = store().add_key({tenant, scopes(allowed), "test", expires});
    REQUIRE(text);
    return *text;
  }
  Result<Caller> admit(const std::string& authorization, Scope scope = Scope::read) {
    HttpRequest request;
    request.headers.emplace_back("authorization", authorization);
    return Gate(store_.get()).admit(request, scope);
  }
  ErrorCode refusal(const std::string& authorization, Scope scope = Scope::read) {
    const auto caller = admit(authorization, scope);
    REQUIRE_FALSE(caller);
    return caller.error().code;
  }

 private:
  test::TemporaryDirectory directory_;
  std::unique_ptr<SqliteTenantStore> store_;
};

}  // namespace

TEST_CASE("scopes are read and written, and admin includes the others") {
  CHECK(to_string(scopes("read,submit")) == "submit,read");
  CHECK(scopes("admin").has(Scope::submit));
  CHECK(scopes("admin").has(Scope::read));
  CHECK_FALSE(scopes("submit").has(Scope::read));
  CHECK_FALSE(scopes("submit,read").has(Scope::admin));
  for (const char* text : {"", "write", ",read", "read,,submit", "Read"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_scopes(text));
  }
}

TEST_CASE("every key is another one, and only its own text is read as one") {
  std::set<std::string> seen;
  for (int i = 0; i < 100; ++i) CHECK(seen.insert(to_string(new_key_text())).second);
  const KeyText key = new_key_text();
  const std::string text = to_string(key);
  REQUIRE(parse_key_text(text));
  CHECK(parse_key_text(text)->id == key.id);
  CHECK(parse_key_text(text)->secret == key.secret);
  CHECK_FALSE(parse_key_text(text + "0"));
  CHECK_FALSE(parse_key_text(text.substr(1)));
  CHECK_FALSE(parse_key_text("fw_" + key.id));
  CHECK_FALSE(parse_key_text("fw_" + key.id + "_" + std::string(64, 'G')));
}

TEST_CASE("a key lets its tenant in, for its scopes") {
  Fixture f;
  const std::string text = f.key("acme", "read");
  const auto caller = f.admit("Bearer " + text);
  REQUIRE(caller);
  CHECK(caller->tenant == "acme");
  CHECK(f.admit("bearer  " + text));
  CHECK(f.refusal("Bearer " + text, Scope::submit) == ErrorCode::forbidden);
  CHECK(f.refusal("Basic " + text) == ErrorCode::unauthorized);
  CHECK(f.refusal("") == ErrorCode::unauthorized);
  CHECK(f.refusal("Bearer " + to_string(new_key_text())) == ErrorCode::unauthorized);
  // The id is known, the secret is not.
  std::string guess = text;
  guess.back() = guess.back() == '0' ? '1' : '0';
  CHECK(f.refusal("Bearer " + guess) == ErrorCode::unauthorized);
}

TEST_CASE("a key ends when it is revoked or its time is over") {
  Fixture f;
  const std::string late = f.key("acme", "read", wall_clock() - 1);
  CHECK(f.refusal("Bearer " + late) == ErrorCode::unauthorized);
  const std::string text = f.key("acme", "read", wall_clock() + 60'000);
  REQUIRE(f.admit("Bearer " + text));
  const auto revoked = f.store().revoke_key(parse_key_text(text)->id);
  REQUIRE(revoked);
  CHECK(revoked->revoked);
  CHECK(f.refusal("Bearer " + text) == ErrorCode::unauthorized);
  const auto again = f.store().revoke_key(parse_key_text(text)->id);
  REQUIRE(again);
  CHECK(again->revoked == revoked->revoked);
  CHECK(f.store().revoke_key("none").error().code == ErrorCode::not_found);
}

TEST_CASE("the store does not know a secret") {
  Fixture f;
  const std::string text = f.key("acme", "read");
  const auto keys = f.store().keys();
  REQUIRE(keys);
  REQUIRE(keys->size() == 1);
  CHECK(keys->front().label == "test");
  auto database = Database::open(f.path());
  REQUIRE(database);
  Query row = database->query("SELECT id || digest || tenant || scopes || label FROM api_key");
  REQUIRE(row.step());
  CHECK(row.text(0).find(parse_key_text(text)->secret) == std::string::npos);
}

TEST_CASE("without a store of keys everybody is the local tenant") {
  const auto caller = Gate(nullptr).admit(HttpRequest{}, Scope::admin);
  REQUIRE(caller);
  CHECK(caller->tenant == kLocalTenant);
}

TEST_CASE("a tenant's share is kept, and nonsense is refused") {
  Fixture f;
  Tenant tenant{"acme", 2.5, 3, 4, 5};
  REQUIRE(f.store().set_tenant(tenant));
  const auto tenants = f.store().tenants();
  REQUIRE(tenants);
  REQUIRE(tenants->size() == 2);
  CHECK(tenants->at(0).name == "acme");
  CHECK(tenants->at(0).weight == 2.5);
  CHECK(tenants->at(0).most_running == 3);
  CHECK(tenants->at(0).most_queued == 4);
  CHECK(tenants->at(0).most_bytes == 5);
  CHECK(tenants->at(1).name == kLocalTenant);
  const std::vector<std::function<void(Tenant&)>> breaks = {
      [](Tenant& t) { t.name = "a b"; },     [](Tenant& t) { t.name = ""; },
      [](Tenant& t) { t.weight = 0; },       [](Tenant& t) { t.most_running = 0; },
      [](Tenant& t) { t.most_queued = -1; }, [](Tenant& t) { t.most_bytes = 0; }};
  for (const auto& spoil : breaks) {
    Tenant broken = tenant;
    spoil(broken);
    CHECK(f.store().set_tenant(broken).error().code == ErrorCode::usage);
  }
}
