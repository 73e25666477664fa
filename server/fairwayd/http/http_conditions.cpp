#include "server/fairwayd/http/http_conditions.h"

#include <algorithm>
#include <optional>

#include "server/fairwayd/http/http_fields.h"

namespace fairway {
namespace {

constexpr std::string_view kWeak = "W/";

/// Takes the next tag off a list; nothing at its end, or where it does not parse. Tags are no
/// quoted strings: a backslash in them is one.
std::optional<EntityTag> take_tag(std::string_view& list) {
  list.remove_prefix(std::min(list.find_first_not_of(", \t"), list.size()));
  EntityTag tag;
  tag.weak = list.starts_with(kWeak);
  if (tag.weak) list.remove_prefix(kWeak.size());
  const std::size_t close = list.find('"', 1);
  if (!list.starts_with('"') || close == std::string_view::npos) return std::nullopt;
  tag.opaque = list.substr(1, close - 1);
  list.remove_prefix(close + 1);
  return tag;
}

bool fits(const EntityTag& a, const EntityTag& b, bool strongly) {
  return a.opaque == b.opaque && !(strongly && (a.weak || b.weak));
}

/// True where a header of this name is "*" or lists the current version.
bool lists(const HttpRequest& request, std::string_view header, const EntityTag& current,
           bool strongly) {
  for (const auto& [name, value] : request.headers) {
    if (name != header) continue;
    if (trim_blanks(value) == "*") return true;
    std::string_view rest = value;
    while (const auto tag = take_tag(rest)) {
      if (fits(*tag, current, strongly)) return true;
    }
  }
  return false;
}

}  // namespace

std::string to_string(const EntityTag& tag) {
  return std::string(tag.weak ? kWeak : "") + '"' + tag.opaque + '"';
}

bool knows_version(const HttpRequest& request, const EntityTag& current) {
  return lists(request, "if-none-match", current, false);
}

Condition evaluate_conditions(const HttpRequest& request, const EntityTag& current) {
  if (request.method != "GET" && request.method != "HEAD") return Condition::proceed;
  if (request.header("if-match") && !lists(request, "if-match", current, true)) {
    return Condition::failed;
  }
  return knows_version(request, current) ? Condition::not_modified : Condition::proceed;
}

bool may_apply_range(const HttpRequest& request, const EntityTag& current) {
  const auto condition = request.header("if-range");
  if (!condition) return true;
  std::string_view rest = trim_blanks(*condition);
  const auto tag = take_tag(rest);
  return tag && rest.empty() && fits(*tag, current, true);
}

}  // namespace fairway
