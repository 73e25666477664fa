#include "server/fairway-submit/problem_answer.h"

#include <fmt/format.h>

#include "proto/messages/problem.h"
#include "server/fairway-submit/json_fields.h"

namespace fairway {

Json problem_of(const HttpAnswer& answer) {
  if (answer.status == 0) {
    const bool own = answer.lost == HttpAnswer::Lost::by_receiver;
    return problem_document({own ? ErrorCode::io : ErrorCode::unavailable,
                             fmt::format("No answer: {}.", answer.reason)});
  }
  if (auto problem = parse_json(answer.body); problem && !text_in(*problem, "title").empty()) {
    return *std::move(problem);
  }
  const std::string place = answer.header("location");
  if (!place.empty() && answer.status >= 300 && answer.status < 400) {
    return problem_document(
        {ErrorCode::bad_request,
         fmt::format("The server sends us to {}: give that one with --server.", place)});
  }
  return problem_document({ErrorCode::bad_request,
                           fmt::format("The answer {} is none of fairwayd's: does --server name "
                                       "one?",
                                       answer.status)});
}

}  // namespace fairway
