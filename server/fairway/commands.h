#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/result.h"

namespace fairway {

// The verbs of the tool. Each prints what it did; an Error is printed by main, which exits with the
// code of its problem.

/// `fairway denoise IN OUT`.
struct DenoiseCommand {
  std::string input;
  std::string output;      ///< its extension chooses the format
  std::string parameters;  ///< JSON text, or the name of a file that holds it
  bool quiet = false;
  bool timings = false;  ///< print how long each stage took
};
Result<void> run(const DenoiseCommand& command);

/// `fairway curvature IN OUT`: the attributes of `denoise`, and nothing moves. Of the parameters
/// those of the flow are without effect, except what says which vertices are features.
struct CurvatureCommand {
  std::string input;
  std::string output;
  std::string parameters;
  bool quiet = false;
  bool timings = false;
};
Result<void> run(const CurvatureCommand& command);

/// `fairway inspect FILE`.
struct InspectCommand {
  std::string input;
  bool json = false;  ///< print the document of proto/messages/inspection.h instead of a table
};
Result<void> run(const InspectCommand& command);

/// `fairway sample SHAPE OUT`.
struct SampleCommand {
  std::string shape;
  std::string output;                ///< its extension chooses the format
  std::optional<std::string> clean;  ///< where to write the same mesh without noise
  std::uint32_t size = 0;            ///< resolution; 0 = the shape's default
  double noise = 0.2;                ///< standard deviation in mean edge lengths
  std::uint64_t seed = 1;
};
Result<void> run(const SampleCommand& command);

/// `fairway compare REFERENCE MESH`.
struct CompareCommand {
  std::string reference;
  std::string mesh;
};
Result<void> run(const CompareCommand& command);

/// `fairway methods`: the flows, presets and parameters.
struct MethodsCommand {
  bool json = false;  ///< print the document of proto/messages/method_catalog.h instead of tables
};
Result<void> run(const MethodsCommand& command);

/// `fairway worker --self-test-sandbox`.
enum class SelfTest {
  confined,
  unconfined,  ///< without any wall: shows what the test is worth, as it must fail
};

/// `fairway worker`: one job of fairwayd, see proto/messages/worker_protocol.h. Returns the exit
/// code.
struct WorkerCommand {
  std::uint64_t address_space = 0;         ///< bytes; 0 = no limit
  std::uint64_t cpu_seconds = 0;           ///< 0 = no limit
  std::optional<SelfTest> self_test = {};  ///< instead of a job
};
int run(const WorkerCommand& command);

/// `fairway submit …`: becomes the program fairway-submit that stands beside this one, with the
/// arguments behind the verb (ended by a null pointer). Returns only an Error: io.
Result<void> run_submit(char** arguments);

}  // namespace fairway
