#pragma once

#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/index.h"
#include "core/result.h"
#include "proto/messages/json.h"

namespace fairway {

/// A value of a closed set and its name in a document.
template <class T>
struct Named {
  std::string_view name;
  T value;
};

/// A closed range of numbers.
struct Range {
  double low, high;
};

/// Fewest and most entries of a list.
struct ListSize {
  std::size_t least, most;
};

/// What a schema says of a text: its pattern and its most bytes.
struct TextForm {
  std::string_view pattern;
  std::size_t most_bytes;
};

/// Reads the members of one JSON object strictly. A getter leaves its target as it is where the key
/// is absent; the first wrong type or value becomes the error (invalid_parameters, with the pointer
/// of the culprit) and everything after it is ignored.
///
/// A describing reader reads nothing. Its getters write down what they would accept as JSON Schema
/// (draft 2020-12), with their targets as the defaults: so a schema has the names, ranges and
/// defaults of the reading code itself.
class ObjectReader {
 public:
  /// `json` must be an object, or null for an absent one, and outlive the reader.
  ObjectReader(const Json& json, std::string pointer);
  static ObjectReader describing();
  /// What a describing reader has been asked for.
  Json schema() const;

  bool holds(std::string_view key) const;

  void boolean(std::string_view key, bool& target);
  void number(std::string_view key, Range range, double& target);
  void number_or_auto(std::string_view key, Range range, std::optional<double>& target);
  void integer(std::string_view key, int low, int high, int& target);
  void integer_or_auto(std::string_view key, int low, int high, std::optional<int>& target);
  /// `false` reads as 0.
  void integer_or_false(std::string_view key, int low, int high, int& target);
  /// 0, or a whole number from `low` on.
  void integer_or_zero(std::string_view key, int low, int high, int& target);

  template <class T>
  void choice(std::string_view key, std::span<const Named<T>> names, T& target) {
    read_choice(key, names, [&target](const T& value) { target = value; });
    describe_choice(key, names_of(names), name_in(names, target));
  }

  template <class T>
  void choice_or_auto(std::string_view key, std::span<const Named<T>> names,
                      std::optional<T>& target) {
    if (find(key) != nullptr && !is_auto(key)) {
      read_choice(key, names, [&target](const T& value) { target = value; });
    }
    std::vector<std::string_view> all = names_of(names);
    all.insert(all.begin(), kAuto);
    describe_choice(key, all, target ? name_in(names, *target) : kAuto);
  }

  /// A string; `complain` answers an empty text, or what is wrong with it. `form`: its schema.
  void text(std::string_view key, TextForm form,
            const std::function<std::string(std::string_view)>& complain, std::string& target);

  /// A list of names of a closed set, none twice; `aliases[i]` is another spelling of `names[i]`.
  /// `target`: which they are, in rising order.
  void names(std::string_view key, std::span<const std::string_view> names,
             std::span<const std::string_view> aliases, std::vector<std::size_t>& target);

  /// An array of indices, whole numbers from 0 to 2³¹ − 1.
  void indices(std::string_view key, ListSize size, std::vector<Index>& target);

  /// An array of at most `most` texts that match `pattern` (as in a JSON Schema), which `accept`
  /// decides.
  void texts(std::string_view key, std::size_t most, std::string_view pattern,
             bool (*accept)(std::string_view), std::vector<std::string>& target);

  using ReadObject = std::function<void(ObjectReader&)>;
  /// An object with the members that `read` takes, where there is one.
  void object_if_given(std::string_view key, const ReadObject& read);
  /// An object with the members that `read` takes, or what `otherwise` takes of the same key.
  void object_or(std::string_view key, const ReadObject& read,
                 const std::function<void()>& otherwise);
  /// A list of objects, not empty, each with the members that `read` takes, or what `otherwise`
  /// takes of the same key.
  void objects_or(std::string_view key, const ReadObject& read,
                  const std::function<void()>& otherwise);
  /// Two numbers that exclude each other; one of them may be something else, such as "auto".
  void not_both(std::string_view key, std::string_view other);
  /// An absent key is an error.
  void require(std::string_view key);

  /// A reader of the object at `key`; an empty one where the key is absent. Its error is brought
  /// back by take_error().
  ObjectReader object(std::string_view key);
  void take_error(const ObjectReader& child);

  /// Call last: a key that no getter asked for is an error.
  void refuse_unknown_keys();

  void fail(std::string_view key, std::string_view reason);
  const std::optional<Error>& error() const { return error_; }

 private:
  static constexpr std::string_view kAuto = "auto";

  template <class T>
  static std::vector<std::string_view> names_of(std::span<const Named<T>> names) {
    std::vector<std::string_view> out;
    for (const Named<T>& named : names) out.push_back(named.name);
    return out;
  }
  template <class T>
  static std::string_view name_in(std::span<const Named<T>> names, const T& value) {
    for (const Named<T>& named : names) {
      if (named.value == value) return named.name;
    }
    return {};
  }

  template <class T, class Take>
  void read_choice(std::string_view key, std::span<const Named<T>> names, const Take& take) {
    const Json* json = find(key);
    if (json == nullptr) return;
    for (const Named<T>& named : names) {
      if (json->is_string() && json->get_ref<const std::string&>() == named.name) {
        return take(named.value);
      }
    }
    fail_choice(key, names_of(names));
  }

  const Json* find(std::string_view key);
  bool is_auto(std::string_view key) const;
  std::optional<double> number_in(std::string_view key, const Json& json, Range range,
                                  std::string_view alternative);
  std::optional<int> integer_in(std::string_view key, const Json& json, int low, int high,
                                std::string_view alternative);
  void fail_choice(std::string_view key, const std::vector<std::string_view>& names);
  void fail_item(std::string_view key, std::size_t item, std::string_view reason);
  void read_names(std::string_view key, const Json& list, std::span<const std::string_view> names,
                  std::span<const std::string_view> aliases, std::vector<std::size_t>& target);
  void read_objects(std::string_view key, const ReadObject& read);

  void describe(std::string_view key, Json schema);
  void describe_choice(std::string_view key, const std::vector<std::string_view>& names,
                       std::string_view chosen);
  void describe_either(std::string_view key, Json alternative);

  const Json* json_;
  std::string pointer_;
  std::set<std::string, std::less<>> known_;
  std::optional<Error> error_;
  std::optional<Json> schema_;  ///< of a describing reader
  std::string key_;             ///< of the parent, where there is one
};

}  // namespace fairway
