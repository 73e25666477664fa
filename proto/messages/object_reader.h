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

/// Reads the members of one JSON object strictly. A getter leaves its target as it is where the key
/// is absent; the first wrong type or value becomes the error (invalid_parameters, with the pointer
/// of the culprit) and everything after it is ignored.
class ObjectReader {
 public:
  /// `json` must be an object, or null for an absent one, and outlive the reader.
  ObjectReader(const Json& json, std::string pointer);

  bool holds(std::string_view key) const;
  bool holds_object(std::string_view key) const;

  void boolean(std::string_view key, bool& target);
  void number(std::string_view key, Range range, double& target);
  void number_or_auto(std::string_view key, Range range, std::optional<double>& target);
  void integer(std::string_view key, int low, int high, int& target);
  void integer_or_auto(std::string_view key, int low, int high, std::optional<int>& target);
  /// `false` reads as 0.
  void integer_or_false(std::string_view key, int low, int high, int& target);

  template <class T>
  void choice(std::string_view key, std::span<const Named<T>> names, T& target) {
    const Json* json = find(key);
    if (json == nullptr) return;
    for (const Named<T>& named : names) {
      if (json->is_string() && json->get_ref<const std::string&>() == named.name) {
        target = named.value;
        return;
      }
    }
    std::string list;
    for (const Named<T>& named : names)
      list += (list.empty() ? "" : ", ") + std::string(named.name);
    fail(key, "must be one of " + list);
  }

  template <class T>
  void choice_or_auto(std::string_view key, std::span<const Named<T>> names,
                      std::optional<T>& target) {
    if (find(key) == nullptr || is_auto(key)) return;
    T value{};
    choice(key, names, value);
    target = value;
  }

  /// A string; `complain` answers an empty text, or what is wrong with it.
  void text(std::string_view key, const std::function<std::string(std::string_view)>& complain,
            std::string& target);
  /// An array of strings; `accept` answers an empty text, or what is wrong with this one.
  void strings(std::string_view key, const std::function<std::string(std::string_view)>& accept);

  /// An array of at most `most` indices, whole numbers from 0 to 2³¹ − 1.
  void indices(std::string_view key, std::size_t most, std::vector<Index>& target);

  /// True where the value is an array that starts with an object.
  bool holds_objects(std::string_view key) const;
  /// An array of objects, each strict too: `read` takes what it knows from a reader of one.
  void objects(std::string_view key, const std::function<void(ObjectReader&)>& read);
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
  const Json* find(std::string_view key);
  bool is_auto(std::string_view key) const;
  std::optional<double> number_in(std::string_view key, const Json& json, Range range,
                                  std::string_view alternative);
  std::optional<int> integer_in(std::string_view key, const Json& json, int low, int high,
                                std::string_view alternative);

  const Json* json_;
  std::string pointer_;
  std::set<std::string, std::less<>> known_;
  std::optional<Error> error_;
};

}  // namespace fairway
