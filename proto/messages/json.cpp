// Strict JSON into an ordered DOM. Source of the limits: nlohmann-json 3.11 copies and dumps
// recursively, and keeps the last of duplicate keys; both are stopped here, before a DOM exists.

#include "proto/messages/json.h"

#include <unordered_set>
#include <vector>

#include <fmt/format.h>

namespace fairway {
namespace {

/// SAX handler that builds the DOM and stops at the first broken rule.
class StrictBuilder : public nlohmann::json_sax<Json> {
 public:
  explicit StrictBuilder(const JsonLimits& limits) : limits_(limits) {}

  bool null() override { return value(nullptr); }
  bool boolean(bool v) override { return value(v); }
  bool number_integer(number_integer_t v) override { return value(v); }
  bool number_unsigned(number_unsigned_t v) override { return value(v); }
  bool number_float(number_float_t v, const string_t& /*text*/) override { return value(v); }
  bool string(string_t& v) override { return value(std::move(v)); }
  bool binary(binary_t& /*v*/) override { return fail("binary values are not JSON"); }
  bool start_object(std::size_t /*size*/) override { return open(Json::object()); }
  bool start_array(std::size_t /*size*/) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& k) override {
    if (!levels_.back().keys.insert(k).second) {
      return fail(fmt::format("the key \"{}\" stands twice in one object",
                              k.size() <= 64 ? k : k.substr(0, 64) + "…"));
    }
    key_ = std::move(k);
    return true;
  }

  bool parse_error(std::size_t position, const std::string& /*token*/,
                   const nlohmann::detail::exception& e) override {
    // 406: a number like 1e999 that no double holds.
    return fail(e.id == 406
                    ? fmt::format("a number near byte {} is too large for a double", position)
                    : fmt::format("not valid JSON near byte {}", position));
  }

  Json take() { return std::move(root_); }
  const std::string& reason() const { return reason_; }

 private:
  struct Level {
    Json* json;
    std::unordered_set<std::string> keys;
  };

  bool fail(std::string reason) {
    if (reason_.empty()) reason_ = std::move(reason);
    return false;
  }

  Json* place(Json json) {
    if (levels_.empty()) {
      root_ = std::move(json);
      return &root_;
    }
    Json& parent = *levels_.back().json;
    if (parent.is_array()) return &parent.get_ref<Json::array_t&>().emplace_back(std::move(json));
    // A duplicate was refused in key(), so there is no need to search: append.
    auto& object =
        static_cast<std::vector<Json::object_t::value_type>&>(parent.get_ref<Json::object_t&>());
    object.emplace_back(std::move(key_), std::move(json));
    return &object.back().second;
  }

  bool value(Json json) {
    place(std::move(json));
    return true;
  }

  bool open(Json json) {
    if (levels_.size() >= limits_.depth) {
      return fail(fmt::format("nested deeper than {} levels", limits_.depth));
    }
    levels_.push_back({place(std::move(json)), {}});
    return true;
  }

  bool close() {
    levels_.pop_back();
    return true;
  }

  JsonLimits limits_;
  Json root_;
  std::string key_;
  // A child's address stays good while it is open: its parent only grows after it was closed.
  std::vector<Level> levels_;
  std::string reason_;
};

}  // namespace

Result<Json> parse_json(std::string_view text, const JsonLimits& limits) {
  // The library takes a NUL for the end of its input.
  if (text.find('\0') != std::string_view::npos) {
    return Error{ErrorCode::malformed_input, "JSON has no NUL bytes."};
  }
  StrictBuilder builder(limits);
  try {
    if (!Json::sax_parse(text.begin(), text.end(), &builder) || !builder.reason().empty()) {
      return Error{ErrorCode::malformed_input, builder.reason() + "."};
    }
  } catch (const nlohmann::json::exception& e) {
    return Error{ErrorCode::malformed_input, fmt::format("This is not valid JSON ({}).", e.id)};
  }
  return builder.take();
}

std::string dump_json(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string child_pointer(std::string_view pointer, std::string_view key) {
  std::string out(pointer);
  out += '/';
  for (const char c : key) {
    if (c == '~') {
      out += "~0";
    } else if (c == '/') {
      out += "~1";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace fairway
