// Regenerates the paper's experiments: pictures, captions with what was measured, and Table 3.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tests/figures/experiments.h"
#include "tests/figures/pages.h"
#include "tests/figures/table3.h"

namespace {

using fairway::Error;
using fairway::ErrorCode;
using fairway::Result;

constexpr const char* kTable = "table3";
constexpr const char* kDocs = "docs";

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  const bool written =
      file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const bool closed = file != nullptr && std::fclose(file) == 0;
  if (!written || !closed) return Error{ErrorCode::io, "Cannot write " + path.string()};
  return {};
}

/// Draws one figure and adds its caption to `captions`.
Result<void> draw(const fairway::Experiment& experiment, const std::filesystem::path& directory,
                  std::string& captions) {
  const Result<fairway::Figure> figure = experiment.run();
  if (!figure) return figure.error();
  const std::filesystem::path path = directory / (figure->name + ".png");
  const fairway::Image image = fairway::compose(*figure);
  if (!figure->caption.empty()) captions += markdown(*figure);
  fmt::print("{}: {} x {}\n", path.string(), image.width(), image.height());
  for (const fairway::Panel& panel : figure->panels) {
    fmt::print("  {:<32} {}\n", panel.title, panel.note);
  }
  return write_png(image, path);
}

Result<void> run(const std::vector<std::string>& names, const std::filesystem::path& directory,
                 const std::filesystem::path& pages) {
  if (std::ranges::find(names, kDocs) != names.end()) return fairway::write_documentation(pages);
  const auto wanted = [&](std::string_view name) {
    return names.empty() || std::ranges::find(names, name) != names.end();
  };
  std::string captions =
      "# Figures\n\nL: mean edge length. Degrees: mean angle between face normals and those of the "
      "clean mesh. Volume: change against the clean mesh. k: predominant principal curvature.\n\n";
  for (const fairway::Experiment& experiment : fairway::experiments()) {
    if (!wanted(experiment.name)) continue;
    if (Result<void> done = draw(experiment, directory, captions); !done) return done;
  }
  if (Result<void> done = write_text(directory / "figures.md", captions); !done) return done;
  if (!wanted(kTable)) return {};
  const Result<std::string> table = fairway::table3();
  if (!table) return table.error();
  fmt::print("{}", *table);
  return write_text(directory / "table3.md", *table);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Regenerates the paper's figures and its Table 3 from generated models."};
  std::vector<std::string> names;
  std::vector<std::string> known = {kTable, kDocs};
  for (const fairway::Experiment& one : fairway::experiments()) known.emplace_back(one.name);
  std::filesystem::path directory = "build/figures";
  std::filesystem::path pages = "server/web/docs";
  app.add_option("names", names, "Which ones; all but docs without a name")
      ->check(CLI::IsMember(known));
  app.add_option("--out", directory, "Where the files go")->capture_default_str();
  app.add_option("--pages", pages, "The pages whose figures docs makes anew")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  if (failed) {
    fmt::print(stderr, "figures: cannot create {}: {}\n", directory.string(), failed.message());
    return 1;
  }
  if (const Result<void> done = run(names, directory, pages); !done) {
    fmt::print(stderr, "figures: {}\n", done.error().message);
    return 1;
  }
  return 0;
}
