#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "proto/messages/json.h"
#include "server/os/child_process.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::test {

/// How a run of a program ended.
struct SubmitRun {
  int code = -1;  ///< −1: a signal ended it
  std::string output;
  std::string errors;

  /// The summary of --json; fails the test where there is none.
  Json summary() const;
};

/// A running fairway-submit.
class SubmitProcess {
 public:
  /// `program`: its file name beside the other programs.
  explicit SubmitProcess(const std::vector<std::string>& arguments,
                         const std::vector<std::string>& environment = {},
                         const std::string& program = "fairway-submit");

  void signal(int number) const { process_->kill(number); }
  pid_t pid() const { return process_->pid(); }
  bool is_over() const;
  SubmitRun wait();

 private:
  TemporaryDirectory directory_;
  std::optional<ChildProcess> process_;
};

/// Files in a folder to submit, a folder for results, and one for a server's data.
class SubmitPlace {
 public:
  /// Writes a file into the folder of inputs; returns its path.
  std::string write(const std::string& name, const std::string& content) const;
  /// Writes so many small meshes, all different.
  std::vector<std::string> write_meshes(int count) const;

  std::filesystem::path data() const { return directory_.path() / "data"; }
  std::filesystem::path out() const { return directory_.path() / "out"; }
  std::string result(const std::string& name) const;
  /// The names in the folder of results, without those that begin with a dot.
  std::vector<std::string> results() const;
  /// How many half-written files lie there.
  std::size_t parts() const;
  /// Waits until the journal of the batch has so many lines with this text.
  void wait_for_journal(const std::string& text, std::size_t lines) const;
  std::string journal() const;

  /// `files`, `--server`, `--out` and what else is wanted.
  std::vector<std::string> arguments(std::uint16_t port, std::vector<std::string> files,
                                     const std::vector<std::string>& more = {}) const;
  SubmitRun submit(std::uint16_t port, const std::vector<std::string>& files,
                   const std::vector<std::string>& more = {}) const;

 private:
  TemporaryDirectory directory_;
};

std::string read_file(const std::filesystem::path& path);

/// A port that nobody has, out of the range that the system gives to connections.
std::uint16_t free_port();

}  // namespace fairway::test
