#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"

namespace fairway {

/// What a key lets its holder do. `admin` includes the others.
enum class Scope : std::uint8_t {
  submit,  ///< make, cancel, retry and delete jobs; inspect
  read,    ///< job documents, lists, events and results
  admin,   ///< metrics
};

inline constexpr std::array kScopes = {Scope::submit, Scope::read, Scope::admin};

/// A set of scopes.
class Scopes {
 public:
  constexpr Scopes() = default;

  constexpr void add(Scope scope) { bits_ |= bit(scope); }
  constexpr bool has(Scope scope) const { return (bits_ & (bit(scope) | bit(Scope::admin))) != 0; }
  constexpr bool lists(Scope scope) const { return (bits_ & bit(scope)) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  friend constexpr bool operator==(Scopes, Scopes) = default;

 private:
  static constexpr unsigned bit(Scope scope) { return 1U << static_cast<unsigned>(scope); }

  unsigned bits_ = 0;
};

/// "submit", "read", "admin".
std::string_view name_of(Scope scope);

/// Reads "submit,read". Errors: usage.
Result<Scopes> parse_scopes(std::string_view text);

/// As parse_scopes() reads it.
std::string to_string(Scopes scopes);

/// A key as it is handed out, once: "fw_<id>_<secret>".
struct KeyText {
  std::string id;      ///< 12 hexadecimal digits; not secret
  std::string secret;  ///< 64 hexadecimal digits, from the kernel's generator
};

KeyText new_key_text();
std::string to_string(const KeyText& key);

/// Nothing where the text has not the shape of a key.
std::optional<KeyText> parse_key_text(std::string_view text);

/// What is stored of a secret: its SHA-256. It has 256 random bits, so a slow hash would add
/// nothing.
std::string digest_of(const KeyText& key);

/// Compares texts of equal length in a time that does not depend on where they differ.
bool same_digest(std::string_view a, std::string_view b);

}  // namespace fairway
