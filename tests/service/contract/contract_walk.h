#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "proto/messages/json.h"
#include "tests/service/support/http_client.h"

namespace fairway::test {

/// An operation of an OpenAPI document.
struct Operation {
  std::string id;
  std::string method;  ///< "GET"
  std::string path;    ///< with {id}
  std::string scope;   ///< that a key needs; "" where none is asked for
  Json parameters;     ///< resolved, those of its path among them
  Json responses;      ///< by status, resolved
  Json body;           ///< of the request, resolved; null where it takes none
};

/// A path with `id` in the place of each {…}.
std::string filled(std::string_view path, const std::string& id);
/// The path of an operation, filled.
std::string path_with(const Operation& operation, const std::string& id);

/// All operations of a document, and what a "$ref" in it means (followed to its end).
std::vector<Operation> operations_of(const Json& document);
Json resolved(const Json& document, const Json& value);

/// Follows one operation: every answer that it gave has to be documented, and in the end every
/// documented answer has to have been given.
class ContractWalk {
 public:
  /// `document` is the served one. Fails the test where there is no such operation.
  ContractWalk(const Json& document, const std::string& operation_id);

  /// Checks an answer against what is documented: status, media type, schema, headers (all that
  /// came, and those that have to) and, of a problem, that its code is among the examples, with the
  /// same type, title and status. Of a stream each event is held against the schema of its name.
  void see(const Answer& answer);

  /// Documented and not seen yet: "404 not_found", "200 succeeded", "200", "200 model/ply". Of HEAD
  /// statuses only.
  std::set<std::string> missing() const;

  const Operation& operation() const { return operation_; }

 private:
  void check_headers(const Json& response, const Answer& answer) const;
  void check_body(const Json& response, const Answer& answer);
  void check_json(const Json& media, const Answer& answer, const std::string& media_type);
  void check_problem(const Json& media, const Json& body) const;
  void check_events(const Json& media, const Answer& answer);
  void check_fits(const Json& value, const Json& schema) const;
  void note(const Answer& answer, const std::string& name);

  const Json& document_;
  Operation operation_;
  std::set<std::string> seen_;
};

/// What an example is known by: the code of a problem, the state of a job, a status of health,
/// else "".
std::string name_of_value(const Json& value);

}  // namespace fairway::test
