// A validator for the keywords of JSON Schema that the project uses.

#include "tests/messages/json_schema.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <regex>
#include <string_view>

namespace fairway::test {
namespace {

bool is_type(const Json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  if (type == "number") return value.is_number();
  return type == "integer" && value.is_number() &&
         value.get<double>() == std::floor(value.get<double>());
}

/// Equal as JSON Schema means it: 1 is 1.0, and the order of keys does not count.
bool equal(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) return a.get<double>() == b.get<double>();
  return nlohmann::json(a) == nlohmann::json(b);
}

class Validator {
 public:
  explicit Validator(const Json& root) : root_(root) {}

  std::string check(const Json& value, const Json& schema, const std::string& at) const {
    if (schema.is_boolean()) return schema.get<bool>() ? "" : at + ": false";
    for (const auto& [keyword, rule] : schema.items()) {
      std::string fault = apply(keyword, rule, value, schema, at);
      if (!fault.empty()) return fault;
    }
    return {};
  }

 private:
  using Rule = std::string (Validator::*)(const Json&, const Json&, const Json&,
                                          const std::string&) const;
  struct Named {
    std::string_view keyword;
    Rule rule;
  };

  std::string apply(const std::string& keyword, const Json& rule, const Json& value,
                    const Json& schema, const std::string& at) const;

  bool holds(const Json& value, const Json& schema) const {
    return check(value, schema, "").empty();
  }
  static std::string fault_unless(bool good, const std::string& at, const char* keyword) {
    return good ? "" : (at.empty() ? "/" : at) + ": " + keyword;
  }

  std::string annotation(const Json&, const Json&, const Json&, const std::string&) const {
    return {};
  }
  std::string reference(const Json& r, const Json& v, const Json&, const std::string& at) const {
    const std::string target = r;
    if (!target.starts_with("#/")) return at + ": reference to " + target;
    const Json::json_pointer pointer(target.substr(1));
    if (!root_.contains(pointer)) return at + ": no " + target;
    return check(v, root_.at(pointer), at);
  }
  std::string type(const Json& r, const Json& v, const Json&, const std::string& at) const {
    if (r.is_string()) return fault_unless(is_type(v, r), at, "type");
    return fault_unless(
        std::any_of(r.begin(), r.end(), [&](const Json& one) { return is_type(v, one); }), at,
        "type");
  }
  std::string enumeration(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(
        std::any_of(r.begin(), r.end(), [&](const Json& one) { return equal(v, one); }), at,
        "enum");
  }
  std::string constant(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(equal(v, r), at, "const");
  }
  std::string minimum(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(!v.is_number() || v.get<double>() >= r.get<double>(), at, "minimum");
  }
  std::string maximum(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(!v.is_number() || v.get<double>() <= r.get<double>(), at, "maximum");
  }
  std::string min_items(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(!v.is_array() || v.size() >= r.get<std::size_t>(), at, "minItems");
  }
  std::string max_items(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(!v.is_array() || v.size() <= r.get<std::size_t>(), at, "maxItems");
  }
  std::string min_length(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(
        !v.is_string() || v.get_ref<const std::string&>().size() >= r.get<std::size_t>(), at,
        "minLength");
  }
  std::string max_length(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(
        !v.is_string() || v.get_ref<const std::string&>().size() <= r.get<std::size_t>(), at,
        "maxLength");
  }
  std::string pattern(const Json& r, const Json& v, const Json&, const std::string& at) const {
    const auto fits = [&] {
      return std::regex_search(v.get_ref<const std::string&>(), std::regex(r.get<std::string>()));
    };
    return fault_unless(!v.is_string() || fits(), at, "pattern");
  }
  std::string required(const Json& r, const Json& v, const Json&, const std::string& at) const {
    if (!v.is_object()) return {};
    for (const Json& key : r) {
      if (!v.contains(key.get<std::string>())) return at + ": required " + key.get<std::string>();
    }
    return {};
  }
  std::string properties(const Json& r, const Json& v, const Json&, const std::string& at) const {
    if (!v.is_object()) return {};
    for (const auto& [key, schema] : r.items()) {
      if (!v.contains(key)) continue;
      std::string fault = check(v.at(key), schema, child_pointer(at, key));
      if (!fault.empty()) return fault;
    }
    return {};
  }
  std::string others(const Json& r, const Json& v, const Json& s, const std::string& at) const {
    if (!v.is_object()) return {};
    for (const auto& [key, member] : v.items()) {
      if (s.contains("properties") && s["properties"].contains(key)) continue;
      std::string fault = check(member, r, child_pointer(at, key));
      if (!fault.empty()) return fault + " (additionalProperties)";
    }
    return {};
  }
  std::string items(const Json& r, const Json& v, const Json&, const std::string& at) const {
    for (std::size_t i = 0; v.is_array() && i < v.size(); ++i) {
      std::string fault = check(v[i], r, at + "/" + std::to_string(i));
      if (!fault.empty()) return fault;
    }
    return {};
  }
  std::string unique(const Json&, const Json& v, const Json&, const std::string& at) const {
    for (std::size_t i = 0; v.is_array() && i < v.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (equal(v[i], v[j])) return at + ": uniqueItems";
      }
    }
    return {};
  }
  std::string contains(const Json& r, const Json& v, const Json&, const std::string& at) const {
    const bool found = v.is_array() && std::any_of(v.begin(), v.end(),
                                                   [&](const Json& one) { return holds(one, r); });
    return fault_unless(!v.is_array() || found, at, "contains");
  }
  std::string any_of(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(
        std::any_of(r.begin(), r.end(), [&](const Json& one) { return holds(v, one); }), at,
        "anyOf");
  }
  std::string all_of(const Json& r, const Json& v, const Json&, const std::string& at) const {
    for (const Json& one : r) {
      std::string fault = check(v, one, at);
      if (!fault.empty()) return fault;
    }
    return {};
  }
  std::string negation(const Json& r, const Json& v, const Json&, const std::string& at) const {
    return fault_unless(!holds(v, r), at, "not");
  }

  const Json& root_;
};

std::string Validator::apply(const std::string& keyword, const Json& rule, const Json& value,
                             const Json& schema, const std::string& at) const {
  static constexpr auto kRules = std::to_array<Named>({
      {"$ref", &Validator::reference},
      {"type", &Validator::type},
      {"enum", &Validator::enumeration},
      {"const", &Validator::constant},
      {"minimum", &Validator::minimum},
      {"maximum", &Validator::maximum},
      {"minItems", &Validator::min_items},
      {"maxItems", &Validator::max_items},
      {"minLength", &Validator::min_length},
      {"maxLength", &Validator::max_length},
      {"pattern", &Validator::pattern},
      {"required", &Validator::required},
      {"properties", &Validator::properties},
      {"additionalProperties", &Validator::others},
      {"items", &Validator::items},
      {"uniqueItems", &Validator::unique},
      {"contains", &Validator::contains},
      {"anyOf", &Validator::any_of},
      {"allOf", &Validator::all_of},
      {"not", &Validator::negation},
      {"$schema", &Validator::annotation},
      {"title", &Validator::annotation},
      {"description", &Validator::annotation},
      {"default", &Validator::annotation},
      {"examples", &Validator::annotation},
      {"format", &Validator::annotation},
      {"contentMediaType", &Validator::annotation},
      {"x-unit", &Validator::annotation},
  });
  const auto* found = std::find_if(kRules.begin(), kRules.end(),
                                   [&](const Named& named) { return named.keyword == keyword; });
  if (found == kRules.end()) return at + ": the keyword " + keyword + " is not known here";
  return (this->*found->rule)(rule, value, schema, at);
}

}  // namespace

std::string schema_fault(const Json& value, const Json& schema, const Json& root) {
  return Validator(root).check(value, schema, "");
}

}  // namespace fairway::test
