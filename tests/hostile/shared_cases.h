#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/hostile/score.h"
#include "tests/hostile/target.h"

namespace fairway::hostile {

/// A file of the shared collection of hostile inputs, as its manifest describes it.
struct SharedCase {
  std::string file;  ///< "glb/ok_cube.glb"
  std::string category;
  std::string expected;  ///< "400|422", "accept"
  std::string bytes;
};

/// All of them; throws Broken where the manifest or a file is not as it says. Nothing where the
/// collection does not stand beside the project.
std::optional<std::vector<SharedCase>> shared_cases();

/// How a case is sent: a submit, or bytes of a whole request.
struct Submit {
  std::string path;
  std::string type;
  std::string body;
};
/// Nothing where it is bytes of a whole request. `control`: the mesh that parameters come with.
std::optional<Submit> submit_of(const SharedCase& shared, const std::string& control);

/// What a case came to.
struct Verdict {
  std::string outcome;  ///< "accept", a status, "closed", "nothing"
  bool has_server_error = false;
  double milliseconds = 0.0;  ///< until the answer, or the job's final state
  std::string detail;         ///< of the problem, for the reader
  std::string heads;          ///< all heads of answers, as they came
  std::string location;       ///< of the job, where there is one
};
Verdict submit(const Target& target, const Submit& submit);
Verdict send_raw(const Target& target, const SharedCase& shared);

/// Whether `outcome` is one of `expected`.
bool is_expected(const SharedCase& shared, const std::string& outcome);

/// Runs all shared cases against one service, each with all points of the collection's oracle but
/// the worker's accesses. `patience` is times every bound.
void run_shared_cases(Score& score, const std::vector<SharedCase>& cases, double patience);

/// Runs those with a mesh again, with the worker's system calls traced, where that can be done.
void run_traced_cases(Score& score, const std::vector<SharedCase>& cases);

}  // namespace fairway::hostile
