// The oracle: what is checked after each case, whatever its class.
#include <algorithm>
#include <cctype>
#include <chrono>
#include <set>
#include <string_view>
#include <thread>

#include <fmt/format.h>

#include "tests/hostile/shared_cases.h"
#include "tests/hostile/wire.h"

namespace fairway::hostile {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr double kLivezBound = 1000.0;
constexpr double kAnswerBound = 5000.0;
constexpr double kTidyBound = 5000.0;
constexpr long kRoomKib = 64L * 1024;
/// A machine that stands still for longer has not measured the service.
constexpr double kStall = 300.0;
constexpr int kTries = 3;
constexpr std::size_t kTellingName = 10;

/// Words of a request that a client chose and no answer of ours contains by itself.
std::set<std::string> telling_names(std::string_view bytes) {
  const auto is_header_name = [](const std::string& word) { return word.ends_with(':'); };
  constexpr std::array<std::string_view, 6> kOurs = {"model/gltf", "multipart/", "application/",
                                                     "/v1/jobs",   "keep-alive", "Connection"};
  std::set<std::string> names;
  std::string word;
  for (const char c : bytes.substr(0, 20000)) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) != 0 || std::string_view("%/.:-_").find(c) != std::string_view::npos) {
      word += c;
      continue;
    }
    const bool ours = std::any_of(kOurs.begin(), kOurs.end(), [&](std::string_view own) {
      return word.find(own) != std::string::npos;
    });
    if (word.size() >= kTellingName && !ours && !is_header_name(word))
      names.insert(word.substr(0, 200));
    word.clear();
  }
  return names;
}

/// Point 7 for the answers' heads: no control character, no word of the request.
std::string echo_in(const std::string& heads, const std::string& input) {
  for (std::size_t i = 0; i < heads.size(); ++i) {
    const auto u = static_cast<unsigned char>(heads[i]);
    const bool line_end = heads[i] == '\r' || heads[i] == '\n';
    if ((u < 0x20 && !line_end) || u >= 0x7f) return "a byte that no header may hold";
  }
  for (const std::string& name : telling_names(input)) {
    if (heads.find(name) != std::string::npos) return "\"" + name + "\"";
  }
  return {};
}

struct Bounds {
  double patience = 1.0;
  long baseline = 0;  ///< KiB
};

/// The points of the oracle that are the service's state. Times are only held against it where
/// this machine itself went on.
void expect_unharmed(Target& target, const LivenessProbe& probe, const Bounds& bounds) {
  expect(target.is_alive(), "the server died");
  expect(target.client().get("/livez").status == 200, "/livez is not answered afterwards");
  const double livez = probe.longest();
  expect(livez < kLivezBound * bounds.patience, fmt::format("/livez took {:.0f} ms", livez));
  const auto ended = steady_clock::now();
  long resident = target.resident();
  while (resident > bounds.baseline + kRoomKib &&
         milliseconds_since(ended) < kTidyBound * bounds.patience) {
    std::this_thread::sleep_for(milliseconds(20));
    resident = target.resident();
  }
  expect(resident <= bounds.baseline + kRoomKib,
         fmt::format("{} KiB in memory after 5 s, {} at first", resident, bounds.baseline));
  const std::string trace = target.traces_of_input();
  expect(trace.empty(), trace);
}

void check_once(Target& target, const LivenessProbe& probe, const Bounds& bounds,
                const SharedCase& shared, const std::string& control) {
  const auto request = submit_of(shared, control);
  const Verdict verdict = request ? submit(target, *request) : send_raw(target, shared);
  expect(!verdict.has_server_error,
         fmt::format("a server error: {}, {}", verdict.outcome, verdict.detail));
  expect(is_expected(shared, verdict.outcome),
         fmt::format("{} instead of {}: {}", verdict.outcome, shared.expected, verdict.detail));
  expect(verdict.milliseconds <= kAnswerBound * bounds.patience,
         fmt::format("{} after {:.0f} ms", verdict.outcome, verdict.milliseconds));
  expect_unharmed(target, probe, bounds);
  const std::string echo = echo_in(verdict.heads, shared.bytes);
  expect(echo.empty(), "an answer's head holds " + echo);
}

}  // namespace

void run_shared_cases(Score& score, const std::vector<SharedCase>& cases, double patience) {
  Target target;
  const auto control = std::find_if(cases.begin(), cases.end(), [](const SharedCase& each) {
    return each.file == "glb/ok_cube.glb";
  });
  expect(control != cases.end(), "the collection has no glb/ok_cube.glb");
  // What the first jobs need for good is no harm done by a case.
  for (int i = 0; i < 3; ++i) submit(target, *submit_of(*control, {}));
  const Bounds bounds{patience, target.resident()};
  LivenessProbe probe(target.port(), milliseconds(25));
  int repeated = 0;
  for (const SharedCase& shared : cases) {
    score.enter(shared.category);
    score.run(shared.file, [&] {
      for (int i = 1;; ++i) {
        probe.restart();
        try {
          return check_once(target, probe, bounds, shared, control->bytes);
        } catch (const Broken&) {
          if (i == kTries || probe.longest_stall() < kStall || !target.is_alive()) throw;
          ++repeated;
        }
      }
    });
  }
  if (repeated > 0) {
    score.tell(
        fmt::format("the machine stood still {} times; those cases were repeated", repeated));
  }
}

}  // namespace fairway::hostile
