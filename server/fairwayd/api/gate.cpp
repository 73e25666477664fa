#include "server/fairwayd/api/gate.h"

#include <fmt/format.h>

#include "server/fairwayd/http/http_fields.h"
#include "server/fairwayd/store/job_store.h"
#include "server/fairwayd/telemetry/clocks.h"

namespace fairway {
namespace {

/// The key of the header; nothing where there is none of its shape.
std::optional<KeyText> key_in(const HttpRequest& request) {
  constexpr std::string_view kScheme = "bearer ";
  const std::string_view value = request.header("authorization").value_or("");
  if (value.size() < kScheme.size() || !same_word(value.substr(0, kScheme.size()), kScheme)) {
    return std::nullopt;
  }
  return parse_key_text(trim_blanks(value.substr(kScheme.size())));
}

bool is_good(const ApiKey& key, UnixMillis now) {
  return !key.revoked && key.expires.value_or(now + 1) > now;
}

}  // namespace

Result<Caller> Gate::admit(const HttpRequest& request, Scope scope) const {
  if (tenants_ == nullptr) return Caller{std::string(kLocalTenant), ""};
  const auto text = key_in(request);
  if (!text) {
    return Error{ErrorCode::unauthorized,
                 "This service asks for a key: send the header \"Authorization: Bearer KEY\"."};
  }
  const auto key = tenants_->find_key(*text);
  if (!key) return key.error();
  if (!*key || !is_good(**key, wall_clock())) {
    return Error{ErrorCode::unauthorized,
                 "The key is unknown, revoked or expired: ask for a new one."};
  }
  if (!(*key)->scopes.has(scope)) {
    return Error{ErrorCode::forbidden,
                 fmt::format("The key lacks the scope {}: use one that has it.", name_of(scope))};
  }
  return Caller{(*key)->tenant, (*key)->id};
}

}  // namespace fairway
