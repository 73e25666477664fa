#pragma once

#define CATCH_CONFIG_RUNNER
#include <string>

#include <catch2/catch.hpp>

namespace fairway::test {

/// For the main file of a suite: what the helpers of the service's tests require is said in one
/// line where it does not hold, and nothing else.
class OneLine : public Catch::StreamingReporterBase<OneLine> {
 public:
  using StreamingReporterBase::StreamingReporterBase;

  // NOLINTNEXTLINE(readability-identifier-naming): the library calls it so
  static std::string getDescription() { return "a line for each requirement that does not hold"; }

  void assertionStarting(const Catch::AssertionInfo&) override {}
  bool assertionEnded(const Catch::AssertionStats& stats) override {
    const auto& result = stats.assertionResult;
    if (result.isOk()) return true;
    stream << result.getSourceInfo() << ": " << result.getExpandedExpression();
    for (const auto& info : stats.infoMessages) stream << "; " << info.message;
    stream << '\n';
    return true;
  }
};
CATCH_REGISTER_REPORTER("one-line", OneLine)

}  // namespace fairway::test
