#include "server/fairwayd/http/http_message.h"

#include <fmt/format.h>

#include "proto/messages/problem.h"

namespace fairway {

std::optional<std::string_view> HttpRequest::header(std::string_view name) const {
  for (const auto& [key, value] : headers) {
    if (key == name) return value;
  }
  return std::nullopt;
}

HttpResponse json_response(const Json& json, int status) {
  HttpResponse response;
  response.status = status;
  response.content_type = "application/json";
  response.body = dump_json(json) + "\n";
  return response;
}

HttpResponse problem_response(const Error& error) {
  HttpResponse response;
  response.status = problem_kind(error.code).status;
  response.content_type = kProblemMediaType;
  response.body = dump_json(problem_document(error)) + "\n";
  if (error.code == ErrorCode::unauthorized) {
    response.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"fairway\"");
  }
  if (error.code == ErrorCode::queue_full || error.code == ErrorCode::unavailable) {
    response.headers.emplace_back("Retry-After", "2");
  }
  return response;
}

std::string refusal_message(const Error& error) {
  const HttpResponse response = problem_response(error);
  std::string message =
      fmt::format("HTTP/1.1 {} Refused\r\nContent-Type: {}\r\nContent-Length: {}\r\n",
                  response.status, response.content_type, response.body.size());
  for (const auto& [name, value] : response.headers) {
    message += fmt::format("{}: {}\r\n", name, value);
  }
  return message + "Connection: close\r\n\r\n" + response.body;
}

}  // namespace fairway
