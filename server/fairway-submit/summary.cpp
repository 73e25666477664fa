#include "server/fairway-submit/summary.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace fairway {
namespace {

constexpr std::array kStates = {FileState::succeeded, FileState::kept, FileState::failed,
                                FileState::unfinished};

double seconds_of(std::chrono::milliseconds time) {
  return static_cast<double>(time.count()) / 1000.0;
}

std::size_t count_of(const BatchReport& report, FileState state) {
  return static_cast<std::size_t>(
      std::count_if(report.outcomes.begin(), report.outcomes.end(),
                    [state](const FileOutcome& outcome) { return outcome.state == state; }));
}

Json file_document(const BatchFile& file, const FileOutcome& outcome,
                   const SubmitOptions& options) {
  Json json{{"file", file.input.string()}, {"state", name_of(outcome.state)}};
  if (!outcome.job.empty()) json["job"] = outcome.job;
  if (!outcome.sha256.empty()) {
    json["result"] = {{"file", (options.out / file.name).string()},
                      {"bytes", outcome.result_bytes},
                      {"sha256", outcome.sha256}};
  }
  json["sent_bytes"] = outcome.sent_bytes;
  json["seconds"] = seconds_of(outcome.took);
  if (!outcome.problem.is_null()) json["problem"] = outcome.problem;
  return json;
}

}  // namespace

Json summary_document(const BatchReport& report, const SubmitOptions& options) {
  Json counts = Json::object();
  for (const FileState state : kStates) counts[name_of(state)] = count_of(report, state);
  Json files = Json::array();
  for (std::size_t i = 0; i < report.files.size(); ++i) {
    files.push_back(file_document(report.files[i], report.outcomes[i], options));
  }
  return Json{{"batch", report.batch},
              {"server", to_string(options.server)},
              {"out", options.out.string()},
              {"exit_code", static_cast<int>(report.exit)},
              {"seconds", seconds_of(report.took)},
              {"counts", std::move(counts)},
              {"files", std::move(files)}};
}

std::string summary_text(const BatchReport& report, const SubmitOptions& options) {
  const std::size_t kept = count_of(report, FileState::kept);
  const std::size_t failed = count_of(report, FileState::failed);
  const std::size_t unfinished = count_of(report, FileState::unfinished);
  std::string text =
      fmt::format("{} of {} results in {}", count_of(report, FileState::succeeded) + kept,
                  report.files.size(), options.out.string());
  if (kept > 0) text += fmt::format(" ({} from before)", kept);
  if (failed > 0) text += fmt::format(", {} failed", failed);
  if (unfinished > 0) text += fmt::format(", {} unfinished", unfinished);
  text += fmt::format(", {:.1f} s\n", seconds_of(report.took));
  switch (report.exit) {
    case SubmitExit::no_server:
      text += fmt::format("{} could not be reached: the same command goes on when it can.\n",
                          to_string(options.server));
      break;
    case SubmitExit::interrupted:
      text += "Interrupted: the same command goes on; accepted jobs go on by themselves.\n";
      break;
    default:
      if (unfinished > 0) text += "The same command tries again what is unfinished.\n";
  }
  return text;
}

}  // namespace fairway
