#include "tests/hostile/attacks.h"

#include <algorithm>

#include <fmt/format.h>

#include "tests/hostile/shared_cases.h"
#include "tests/service/support/sample_glb.h"

namespace fairway::hostile {
namespace {

constexpr long kPeakKib = 256L * 1024 + 2L * static_cast<long>(kBodyLimit / 1024);
constexpr double kLivezBound = 1000.0;
constexpr double kStall = 300.0;
constexpr int kTries = 3;

}  // namespace

Field::Field(Score& score, double patience)
    : score_(score),
      patience_(patience),
      target_({"--max-body", fmt::to_string(kBodyLimit), "--workers", "1"}),
      probe_(target_.port(), std::chrono::milliseconds(10)) {}

void Field::expect_unharmed() {
  expect(target_.is_alive(), "the server died");
  expect(target_.client().get("/livez").status == 200, "/livez is not answered afterwards");
  expect(target_.peak() <= kPeakKib, fmt::format("{} KiB in memory at most", target_.peak()));
  const double livez = probe_.longest();
  expect(livez < kLivezBound * patience_, fmt::format("/livez took {:.0f} ms", livez));
  const std::string trace = target_.traces_of_input();
  expect(trace.empty(), trace);
}

void Field::expect_refused(Wire& wire, const std::string& statuses) const {
  wire.read_until_closed(kPatience);
  const Answers answers = answers_in(wire.received());
  const std::string seen =
      answers.whole.empty() ? "no answer" : fmt::format("{}", answers.whole.front().status);
  expect(("|" + statuses + "|").find("|" + seen + "|") != std::string::npos,
         fmt::format("{} instead of {}", seen, statuses));
  expect(answers.whole.size() == 1, "more than one answer to one refused request");
  expect(wire.is_closed(), "the connection is left open after a refusal");
  expect(answers.whole.front().header("connection") == "close", "no Connection: close");
}

void Field::expect_refused(const std::string& head, const std::string& rest,
                           const std::string& statuses) const {
  Wire wire(port());
  wire.send(head + rest, kPatience);
  expect_refused(wire, statuses);
}

void Field::expect_serving() {
  // Work of its own: an equal one would have a result.
  const std::string path =
      fmt::format("/v1/jobs?params=%7B%22feature_angle%22%3A{}.5%7D", 20 + ++jobs_);
  const Verdict verdict = submit(target_, {path, "model/gltf-binary", test::small_glb()});
  expect(verdict.outcome == "accept",
         fmt::format("an honest job: {} {}", verdict.outcome, verdict.detail));
}

std::string Field::large_result() {
  const Verdict verdict = submit(target_, {"/v1/jobs?params=%7B%22steps%22%3A1%7D",
                                           "model/gltf-binary", test::noisy_torus(250)});
  expect(verdict.outcome == "accept", "a large mesh: " + verdict.outcome + " " + verdict.detail);
  return verdict.location + "/result";
}

std::string upload_head(const std::vector<std::string>& lines) {
  std::vector<std::string> all = lines;
  all.emplace_back("Content-Type: model/gltf-binary");
  return head_of("POST", "/v1/jobs", all);
}

std::vector<Attack> attacks() {
  std::vector<Attack> all;
  for (const auto& some : {framing_attacks(), form_attacks(), crowd_attacks()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

void run_attack(Score& score, const Attack& attack, double patience) {
  score.enter(fmt::format("attack: {}", attack.name));
  score.run(std::string(attack.what), [&] {
    for (int i = 1;; ++i) {
      Field field(score, patience);
      try {
        attack.run(field);
        field.expect_unharmed();
        score.note(fmt::format("peak {} MiB, /livez p99 {:.1f} ms of {}",
                               field.target().peak() / 1024, quantile(field.probe().times(), 0.99),
                               field.probe().times().size()));
        return;
      } catch (const Broken&) {
        // A machine that stood still has not measured the service.
        if (i == kTries || field.probe().longest_stall() < kStall) throw;
      }
    }
  });
}

}  // namespace fairway::hostile
