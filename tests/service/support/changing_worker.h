#pragma once

#include <string>

#include "tests/service/support/temporary_directory.h"

namespace fairway::test {

/// A program in the place of `fairway`, which may be changed while the service runs.
class ChangingWorker {
 public:
  /// At first it is `fairway`.
  ChangingWorker();
  explicit ChangingWorker(const std::string& script) { become(script); }

  std::string path() const { return directory_.path() / "worker"; }
  /// Replaces the program by a script of the shell, in one step.
  void become(const std::string& script) const;
  std::string place(const std::string& name) const { return directory_.path() / name; }

 private:
  TemporaryDirectory directory_;
};

}  // namespace fairway::test
