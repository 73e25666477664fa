// Benchmarks of core: every stage on synthetic meshes, beside plain implementations in the same
// run. The steps measured are those of a default run: automatic feature angle, guards,
// displacement, from the noisy surface until the run ends.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/curvature.h"
#include "core/denoise.h"
#include "core/packed_flow.h"
#include "core/packed_mesh.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"
#include "core/weld.h"
#include "server/os/memory.h"
#include "tests/bench/default_step.h"
#include "tests/bench/implicit_bench.h"
#include "tests/bench/plain_flow.h"
#include "tests/bench/report.h"

namespace fairway::bench {
namespace {

/// A torus of about n vertices with noise of so many mean edges.
IndexedMesh synthetic(std::size_t n, double noise) {
  const auto tube = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(n) / 2.0)));
  return with_normal_noise(torus(2 * tube, tube, 1.0, 0.4), noise, 1);
}

IndexedMesh shuffled(const IndexedMesh& mesh) {
  std::mt19937 engine(7);
  std::vector<Index> to(mesh.positions.size());
  std::iota(to.begin(), to.end(), Index{0});
  std::shuffle(to.begin(), to.end(), engine);
  IndexedMesh out = mesh;
  for (std::size_t v = 0; v < to.size(); ++v) out.positions[to[v]] = mesh.positions[v];
  for (Triangle& t : out.triangles) t = {to[t[0]], to[t[1]], to[t[2]]};
  std::shuffle(out.triangles.begin(), out.triangles.end(), engine);
  return out;
}

class Bench {
 public:
  Bench(const Settings& settings, const Report& report, const IndexedMesh& source,
        std::string order)
      : settings_(settings),
        report_(report),
        source_(source),
        order_(std::move(order)),
        mesh_(*TriangleMesh::build(source)),
        mean_edge_(mean_edge_length(mesh_, mesh_.positions())),
        held_(mesh_.vertex_count(), 0) {}

  void run() {
    compare("weld", [this] { (void)weld_equal_positions(source_.positions); }, {});
    compare(
        "topology", [this] { (void)TriangleMesh::build(source_); },
        [this] { (void)plain_topology(source_); });
    compare("reorder", [this] { const PackedMesh packed(mesh_); }, {});
    steps("amc_step", Method::anisotropic, &PlainFlow::amc_step);
    steps("pmc_step", Method::anisotropic_prescribed, &PlainFlow::pmc_step);
    if (wanted("implicit_step")) {
      report_.line(named("implicit_step"), implicit_step(mesh_, mean_edge_, execution(), runs()));
    }
    variational();
    compare("curvature", [this] { (void)curvature(mesh_, mesh_.positions(), execution()); }, {});
    compare("reorder+10amc",
            [this] {
              const std::unique_ptr<PackedFlow> run = flow(Method::anisotropic);
              for (int i = 0; i < 10; ++i) default_step(*run);
            },
            {});
  }

 private:
  Case named(std::string name) const { return {std::move(name), mesh_.vertex_count(), order_}; }
  bool wanted(const std::string& stage) const {
    const std::vector<std::string>& stages = settings_.stages;
    return stages.empty() || std::find(stages.begin(), stages.end(), stage) != stages.end();
  }
  int runs() const { return mesh_.vertex_count() > kLarge ? 2 : 5; }
  void compare(const std::string& name, const std::function<void()>& ours,
               const std::function<void()>& baseline) const {
    if (wanted(name)) report_.line(named(name), in_turn(runs(), ours, baseline));
  }

  /// A default run, beside the 3000 steps of the AMC kernel that it is to take no longer than.
  void variational() const {
    if (!wanted("variational")) return;
    const std::function<void()> kernel_steps = [this] {
      const std::unique_ptr<PackedFlow> run = flow(Method::anisotropic);
      for (int i = 0; i < kStepsOfDefaultRun; ++i) default_step(*run);
    };
    const bool large = mesh_.vertex_count() > kLarge;
    report_.line(named("variational"),
                 in_turn(
                     large ? 1 : 2, [this] { (void)denoise(mesh_, {}, {}, {}, execution()); },
                     large ? std::function<void()>() : kernel_steps));
  }

  Execution execution() const {
    Execution out;
    out.threads = settings_.threads;
    for (const Isa isa : {Isa::portable, Isa::avx2, Isa::avx512}) {
      if (settings_.isa == name_of(isa)) out.isa = isa;
    }
    return out;
  }

  std::unique_ptr<PackedFlow> flow(Method method) const {
    FlowOptions options;
    options.method = method;
    std::unique_ptr<PackedFlow> out =
        PackedFlow::create(mesh_, mesh_.positions(), mean_edge_, held_, options, execution());
    out->mark_start();
    return out;
  }

  /// Steps of an automatic run.
  std::size_t default_steps(Method method) const {
    FlowOptions options;
    options.method = method;
    return denoise(mesh_, options, {}, {}, execution())->report.steps.size();
  }

  /// What the plain code starts from: positions of the source, λ as a length.
  struct State {
    std::vector<Vec3> positions;
    double lambda = 0.0;
  };
  std::vector<State> states(Method method, std::size_t count) const {
    std::vector<State> out;
    const std::unique_ptr<PackedFlow> run = flow(method);
    for (std::size_t k = 0; k < count; ++k) {
      const bool wanted = out.size() < kPlainSteps && k == out.size() * count / kPlainSteps;
      if (wanted) {
        out.push_back({mesh_.scatter_positions(source_, run->positions(mesh_.positions()))});
      }
      const double lambda = default_step(*run);
      if (wanted) out.back().lambda = lambda * mean_edge_;
    }
    return out;
  }

  /// All steps of a default run, each in its least time, in turn with the plain code, which does
  /// some of them, spread over the run: from the same positions, with the same λ, with warm caches.
  void steps(const std::string& name, Method method,
             void (PlainFlow::*plain_step)(double, double)) const {
    if (!wanted(name)) return;
    PlainFlow plain(source_);
    const std::size_t count = default_steps(method);
    const std::vector<State> from = states(method, count);
    std::vector<double> ours(count, kLong);
    std::vector<double> theirs(from.size(), kLong);
    Case c = named(name);
    const bool large = mesh_.vertex_count() > kLarge;
    const auto many = static_cast<int>(kManySteps / count);
    for (int i = 0; i < (large ? 2 : many); ++i) {
      const std::unique_ptr<PackedFlow> run = flow(method);
      for (double& time : ours) {
        time = std::min(time, seconds_of([&] { default_step(*run); }));
      }
      for (std::size_t k = 0; k < from.size(); ++k) {
        for (int pass = 0; pass < (large ? 1 : 2); ++pass) {
          plain.set_positions(from[k].positions);
          theirs[k] =
              std::min(theirs[k], seconds_of([&] {
                         (plain.*plain_step)(from[k].lambda, kStepSize * mean_edge_ * mean_edge_);
                       }));
        }
      }
      c.bytes_per_vertex =
          static_cast<double>(run->kernel_bytes()) / static_cast<double>(c.vertices);
    }
    const auto mean = [](const std::vector<double>& times) {
      return std::accumulate(times.begin(), times.end(), 0.0) / static_cast<double>(times.size());
    };
    report_.line(c, {mean(ours), mean(theirs)});
  }

  static constexpr int kStepsOfDefaultRun = 3000;
  static constexpr std::size_t kLarge = 200'000;
  static constexpr std::size_t kPlainSteps = 4;
  static constexpr std::size_t kManySteps = 500;
  static constexpr double kLong = std::numeric_limits<double>::max();

  const Settings& settings_;
  const Report& report_;
  const IndexedMesh& source_;
  const std::string order_;
  const TriangleMesh mesh_;
  const double mean_edge_;
  const std::vector<unsigned char> held_;
};

}  // namespace
}  // namespace fairway::bench

int main(int argc, char** argv) {
  fairway::bench::Settings settings;
  settings.isa = fairway::name_of(fairway::best_isa());
  CLI::App app("Benchmarks of core", "core_bench");
  app.add_flag("--json", settings.json, "One JSON line per case");
  app.add_option("--threads", settings.threads, "Threads of the kernels")->capture_default_str();
  app.add_option("--isa", settings.isa, "portable, avx2 or avx512")->capture_default_str();
  app.add_option("--noise", settings.noise, "Noise of the meshes, in mean edges")
      ->capture_default_str();
  app.add_option("--stages", settings.stages, "Only these")->delimiter(',');
  app.add_option("--sizes", settings.sizes, "Numbers of vertices")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  // As the worker does.
  const std::size_t largest = *std::max_element(settings.sizes.begin(), settings.sizes.end());
  fairway::prepare_heap(fairway::heap_estimate(36 * largest));
  const fairway::bench::Report report(settings);
  for (const std::size_t size : settings.sizes) {
    const fairway::IndexedMesh natural = fairway::bench::synthetic(size, settings.noise);
    fairway::bench::Bench(settings, report, natural, "natural").run();
    const fairway::IndexedMesh random = fairway::bench::shuffled(natural);
    fairway::bench::Bench(settings, report, random, "shuffled").run();
  }
  return 0;
}
