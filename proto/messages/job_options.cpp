#include "proto/messages/job_options.h"

#include <algorithm>
#include <utility>

#include "proto/messages/object_reader.h"
#include "proto/messages/webhook_url.h"

namespace fairway {
namespace {

constexpr int kShortestTtl = 60;
constexpr int kLongestTtl = 365 * 86'400;
constexpr int kLongestDeadline = 86'400;

std::optional<std::chrono::seconds> seconds_at(ObjectReader& reader, std::string_view key, int low,
                                               int high) {
  std::optional<int> value;
  reader.integer_or_auto(key, low, high, value);
  return value ? std::optional(std::chrono::seconds(*value)) : std::nullopt;
}

void read_webhook(ObjectReader& child, std::optional<Webhook>& target) {
  Webhook webhook;
  child.require("url");
  child.text("url", {kWebhookUrlPattern, kMaxWebhookUrlBytes}, webhook_url_complaint, webhook.url);
  target = std::move(webhook);
}

void read_members(ObjectReader& reader, JobOptions& options) {
  reader.texts("labels", kMaxLabels, "^[A-Za-z0-9._:/@+=-]{1,100}$", &is_label, options.labels);
  reader.integer("priority", -kHighestPriority, kHighestPriority, options.priority);
  options.ttl = seconds_at(reader, "ttl", kShortestTtl, kLongestTtl);
  options.deadline = seconds_at(reader, "deadline", 1, kLongestDeadline);
  reader.object_if_given("webhook",
                         [&options](ObjectReader& child) { read_webhook(child, options.webhook); });
}

}  // namespace

bool is_label(std::string_view text) {
  constexpr std::string_view kMarks = "._:/@+=-";
  return !text.empty() && text.size() <= kMaxLabelBytes &&
         std::all_of(text.begin(), text.end(), [kMarks](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                  kMarks.find(c) != std::string_view::npos;
         });
}

Result<JobOptions> read_job_options(const Json& json) {
  if (!json.is_object()) {
    return Error{ErrorCode::invalid_parameters,
                 "The options of a job must be a JSON object, for example {}."};
  }
  JobOptions options;
  ObjectReader reader(json, "");
  read_members(reader, options);
  reader.refuse_unknown_keys();
  if (reader.error()) return *reader.error();
  std::sort(options.labels.begin(), options.labels.end());
  options.labels.erase(std::unique(options.labels.begin(), options.labels.end()),
                       options.labels.end());
  return options;
}

Result<JobOptions> parse_job_options(std::string_view text) {
  if (text.empty()) return JobOptions{};
  const Result<Json> json = parse_json(text);
  if (!json) {
    return Error{ErrorCode::malformed_parameters,
                 "The options of the job cannot be parsed: " + json.error().message};
  }
  return read_job_options(*json);
}

Json job_options_schema() {
  ObjectReader reader = ObjectReader::describing();
  JobOptions options;
  read_members(reader, options);
  return reader.schema();
}

Json job_options_document(const JobOptions& options) {
  Json document = Json::object();
  if (!options.labels.empty()) document["labels"] = options.labels;
  if (options.priority != 0) document["priority"] = options.priority;
  if (options.ttl) document["ttl"] = options.ttl->count();
  if (options.deadline) document["deadline"] = options.deadline->count();
  if (options.webhook) document["webhook"] = Json{{"url", options.webhook->url}};
  return document;
}

}  // namespace fairway
