#include "server/fairway-submit/plan.h"

#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "proto/messages/format.h"
#include "server/fairway-submit/out_directory.h"

namespace fairway {
namespace {

namespace fs = std::filesystem;

/// The place that a path means, whether or not there is a file.
fs::path place_of(const fs::path& path) {
  std::error_code failed;
  fs::path place = fs::weakly_canonical(path, failed);
  return failed ? fs::absolute(path, failed).lexically_normal() : place;
}

std::optional<Format> chosen_output(const Json& parameters) {
  const auto output = parameters.find("output");
  if (output == parameters.end() || !output->is_string()) return std::nullopt;
  return format_of_name(output->get_ref<const std::string&>());
}

/// An extension that is none of ours is part of the name: "head.v2" becomes "head.v2.ply".
std::string result_name(const fs::path& input, std::optional<Format> output) {
  std::string name = input.filename().string();
  if (!output || format_of_file_name(name) == output) return name;
  const std::string stem = format_of_file_name(name) ? input.stem().string() : name;
  return fmt::format("{}.{}", stem, name_of(*output));
}

}  // namespace

Result<std::vector<BatchFile>> plan_batch(const SubmitOptions& options) {
  const std::optional<Format> output = chosen_output(options.parameters);
  std::set<fs::path> inputs;
  for (const fs::path& input : options.files) inputs.insert(place_of(input));
  std::vector<BatchFile> files;
  std::map<std::string, fs::path> owners;
  for (const fs::path& input : options.files) {
    BatchFile file{input, result_name(input, output)};
    if (!input.has_filename() || input.filename() == "." || input.filename() == ".." ||
        is_own_name(file.name)) {
      return Error{ErrorCode::usage, fmt::format("{} cannot be a mesh file.", input.string())};
    }
    const auto [owner, first] = owners.emplace(file.name, input);
    if (!first) {
      return Error{ErrorCode::usage,
                   fmt::format("The results of {} and {} would both be {}: submit them to two "
                               "folders, or rename one.",
                               owner->second.string(), input.string(), file.name)};
    }
    if (inputs.contains(place_of(options.out / file.name))) {
      return Error{ErrorCode::usage,
                   fmt::format("The result of {} would replace an input: choose another --out.",
                               input.string())};
    }
    files.push_back(std::move(file));
  }
  return files;
}

}  // namespace fairway
