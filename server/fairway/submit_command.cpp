// `fairway submit`: another program, because the tool knows no network.

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "server/fairway/commands.h"
#include "server/os/file.h"

namespace fairway {

Result<void> run_submit(char** arguments) {
  std::error_code failed;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (failed) return Error{ErrorCode::io, system_sentence("find this program", failed.value())};
  std::string program = (self.parent_path() / "fairway-submit").string();
  std::vector<char*> all{program.data()};
  for (; *arguments != nullptr; ++arguments) all.push_back(*arguments);
  all.push_back(nullptr);
  ::execv(program.c_str(), all.data());
  const int reason = errno;
  if (reason == ENOENT) {
    return Error{ErrorCode::io,
                 fmt::format("{} is not there: install fairway-submit beside fairway, or build it "
                             "(ninja fairway-submit).",
                             program)};
  }
  return Error{ErrorCode::io, system_sentence("start " + program, reason)};
}

}  // namespace fairway
