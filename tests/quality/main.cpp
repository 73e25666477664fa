// How good the default run is: models × noises × seeds, beside what other programs reach.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/denoise.h"
#include "tests/places.h"
#include "tests/quality/cases.h"
#include "tests/quality/noise.h"
#include "tests/quality/peers.h"
#include "tests/quality/reference_surface.h"
#include "tests/quality/score.h"

namespace fairway::quality {
namespace {

struct Settings {
  std::vector<std::string> models = shared_models();
  std::vector<std::string> noises = {"n0.1", "n0.2", "n0.3", "r0.2", "r0.3", "i0.5"};
  int seeds = 3;
  int first_seed = 1;
  unsigned threads = 1;
  bool oracle = false;
  bool scanner = false;
  bool clean = false;
  std::string json;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The least error along the path of the run that was done, chosen with the clean mesh.
double best_on_path(const ReferenceSurface& reference, const IndexedMesh& noisy,
                    const TriangleMesh& mesh, FlowOptions options, unsigned threads) {
  Execution execution;
  execution.threads = threads;
  double best = std::numeric_limits<double>::infinity();
  for (int step = 0; step <= 24; ++step) {
    options.strength = step / 24.0;
    const Result<Denoised> run = denoise(mesh, options, {}, {}, execution);
    if (!run) continue;
    best = std::min(best,
                    reference.compare(mesh.scatter_positions(noisy, run->positions)).normal_error);
  }
  return best;
}

std::optional<Score> score(const Settings& settings, const Model& model,
                           const ReferenceSurface& reference, const std::string& noise, int seed) {
  IndexedMesh noisy = model.mesh;
  noisy.positions = with_noise(model.mesh, noise, static_cast<std::uint64_t>(seed));
  const Result<TriangleMesh> mesh = TriangleMesh::build(noisy);
  if (!mesh) return std::nullopt;
  Execution execution;
  execution.threads = settings.threads;
  const auto start = std::chrono::steady_clock::now();
  const Result<Denoised> run = denoise(*mesh, {}, {}, {}, execution);
  Score out{model.name, noise, seed, model.sharp};
  out.seconds = seconds_since(start);
  if (!run) {
    std::cerr << model.name << ' ' << noise << ": " << run.error().message << '\n';
    return std::nullopt;
  }
  out.vertices = mesh->vertex_count();
  out.moved = run->report.rms_displacement;
  out.result = reference.compare(mesh->scatter_positions(noisy, run->positions));
  out.noise_found = run->report.noise_kind == FoundNoise::none         ? "none"
                    : run->report.noise_kind == FoundNoise::correlated ? "correlated"
                                                                       : "white";
  out.chosen = run->report.pass_band > 0.0 ? fmt::format("low {:.2f}", run->report.pass_band)
                                           : std::to_string(run->report.chosen_step);
  if (settings.oracle) {
    out.best_on_path = best_on_path(reference, noisy, *mesh, {}, settings.threads);
  }
  return out;
}

int run(const Settings& settings) {
  std::map<std::pair<std::string, std::string>, Peers> peers;
  if (const auto file = test::shared("data/denoise/peers.json")) peers = read_peers(*file);
  std::vector<Score> scores;
  print_head();
  for (const std::string& name : settings.models) {
    const std::optional<Model> clean = model(name);
    if (!clean) continue;
    const ReferenceSurface reference(clean->mesh);
    for (const std::string& noise : settings.noises) {
      for (int seed = settings.first_seed; seed < settings.first_seed + settings.seeds; ++seed) {
        std::optional<Score> one = score(settings, *clean, reference, noise, seed);
        if (!one) return 1;
        if (const auto found = peers.find({name, noise}); found != peers.end()) {
          one->peers = found->second;
        }
        print(*one);
        scores.push_back(std::move(*one));
      }
    }
  }
  print_summary(scores);
  if (!settings.json.empty()) std::ofstream(settings.json) << document(scores).dump(1) << '\n';
  return 0;
}

}  // namespace
}  // namespace fairway::quality

int main(int argc, char** argv) {
  using namespace fairway::quality;
  Settings settings;
  CLI::App app("Quality of the default run, beside other programs");
  app.add_option("--models", settings.models, "Shared or generated models")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--noises", settings.noises, "Kind and strength: n r i s d q o, as in n0.2")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--seeds", settings.seeds, "How many of each")->capture_default_str();
  app.add_option("--first-seed", settings.first_seed, "The first of them")->capture_default_str();
  app.add_option("--threads", settings.threads, "Threads of a run")->capture_default_str();
  app.add_flag("--oracle", settings.oracle, "Also the best stop on the path, by the clean mesh");
  app.add_flag("--scanner", settings.scanner, "Generated shapes with the noise of scanners");
  app.add_flag("--clean", settings.clean, "No noise: how far the models move");
  app.add_option("--json", settings.json, "File for all figures");
  CLI11_PARSE(app, argc, argv);
  if (settings.scanner) {
    if (app.count("--models") == 0) settings.models = generated_models();
    if (app.count("--noises") == 0) {
      settings.noises = {"s0.1", "s0.2", "d0.1", "d0.2", "d0.4", "q0.1", "q0.2", "o0.2"};
    }
    settings.oracle = true;
  }
  if (settings.clean && app.count("--noises") == 0) {
    settings.noises = {"n0"};
    settings.seeds = 1;
  }
  return run(settings);
}
