#include "server/fairwayd/store/access.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>
#include <openssl/crypto.h>

#include "server/os/random_id.h"
#include "server/os/sha256.h"

namespace fairway {
namespace {

constexpr std::string_view kPrefix = "fw_";
constexpr std::size_t kIdBytes = 6;
constexpr std::size_t kSecretBytes = 32;

bool is_hexadecimal(std::string_view text, std::size_t bytes) {
  return text.size() == 2 * bytes && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

}  // namespace

std::string_view name_of(Scope scope) {
  switch (scope) {
    case Scope::submit:
      return "submit";
    case Scope::read:
      return "read";
    case Scope::admin:
      return "admin";
  }
  return "";
}

Result<Scopes> parse_scopes(std::string_view text) {
  Scopes scopes;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view name = text.substr(0, comma);
    const auto* found = std::find_if(kScopes.begin(), kScopes.end(),
                                     [name](Scope scope) { return name_of(scope) == name; });
    if (found == kScopes.end()) {
      return Error{ErrorCode::usage,
                   fmt::format("There is no scope \"{}\": they are submit, read and admin.", name)};
    }
    scopes.add(*found);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  if (scopes.empty()) return Error{ErrorCode::usage, "A key needs a scope, such as submit,read."};
  return scopes;
}

std::string to_string(Scopes scopes) {
  std::string text;
  for (const Scope scope : kScopes) {
    if (!scopes.lists(scope)) continue;
    if (!text.empty()) text += ',';
    text += name_of(scope);
  }
  return text;
}

KeyText new_key_text() {
  return {random_hexadecimal(kIdBytes), random_hexadecimal(kSecretBytes)};
}

std::string to_string(const KeyText& key) {
  return fmt::format("{}{}_{}", kPrefix, key.id, key.secret);
}

std::optional<KeyText> parse_key_text(std::string_view text) {
  if (!text.starts_with(kPrefix)) return std::nullopt;
  text.remove_prefix(kPrefix.size());
  const std::size_t line = text.find('_');
  if (line == std::string_view::npos) return std::nullopt;
  const std::string_view id = text.substr(0, line);
  const std::string_view secret = text.substr(line + 1);
  if (!is_hexadecimal(id, kIdBytes) || !is_hexadecimal(secret, kSecretBytes)) return std::nullopt;
  return KeyText{std::string(id), std::string(secret)};
}

std::string digest_of(const KeyText& key) {
  Sha256 hash;
  hash.update(std::as_bytes(std::span(key.secret)));
  return hash.hex();
}

bool same_digest(std::string_view a, std::string_view b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace fairway
