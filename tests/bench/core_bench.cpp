// Benchmarks of core: every stage on synthetic meshes, beside plain implementations in the same
// run. The steps measured are those of a default run: automatic feature angle, guards,
// displacement.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/resource.h>

#include "core/curvature.h"
#include "core/denoise.h"
#include "core/edge_geometry.h"
#include "core/packed_flow.h"
#include "core/packed_mesh.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"
#include "core/weld.h"
#include "tests/bench/plain_flow.h"

namespace fairway::bench {
namespace {

constexpr int kSteps = 20;

double seconds_now() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

double seconds_of(const std::function<void()>& work) {
  const double start = seconds_now();
  work();
  return seconds_now() - start;
}

double median_of(std::vector<double> times) {
  std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

/// Median time of five runs of ours, and of the baseline in turn with them.
struct Times {
  double ours = 0.0;
  double baseline = 0.0;
};
Times in_turn(const std::function<void()>& ours, const std::function<void()>& baseline) {
  std::vector<double> a;
  std::vector<double> b;
  for (int i = 0; i < 5; ++i) {
    a.push_back(seconds_of(ours));
    if (baseline) b.push_back(seconds_of(baseline));
  }
  return {median_of(a), baseline ? median_of(b) : 0.0};
}

struct Settings {
  bool json = false;
  unsigned threads = 1;
  std::string isa;
  std::vector<std::size_t> sizes = {4'000, 35'000, 130'000, 500'000, 1'600'000};
};

struct Case {
  std::string name;
  std::size_t vertices;
  std::string order;
  double bytes_per_vertex = 0.0;
};

class Report {
 public:
  explicit Report(const Settings& settings) : settings_(settings) {
    if (settings_.json) return;
    fmt::print("{:<14}{:>10} {:<9}{:>12}{:>12}{:>8}{:>9}{:>10}\n", "stage", "vertices", "order",
               "ns/vertex", "plain", "ratio", "bytes/v", "peak MB");
  }

  void line(const Case& c, const Times& times) const {
    const auto per_vertex = [&c](double seconds) {
      return seconds * 1e9 / static_cast<double>(c.vertices);
    };
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    const double ratio = times.baseline > 0.0 ? times.baseline / times.ours : 0.0;
    if (settings_.json) {
      fmt::print(
          R"({{"name":"{}","vertices":{},"order":"{}","threads":{},"isa":"{}","ns_per_vertex":{:.2f},)"
          R"("baseline":{},"ratio":{},"bytes_per_vertex":{:.1f},"peak_rss":{}}})"
          "\n",
          c.name, c.vertices, c.order, settings_.threads, settings_.isa, per_vertex(times.ours),
          times.baseline > 0.0 ? fmt::format("{:.2f}", per_vertex(times.baseline)) : "null",
          ratio > 0.0 ? fmt::format("{:.3f}", ratio) : "null", c.bytes_per_vertex,
          usage.ru_maxrss * 1024);
    } else {
      fmt::print("{:<14}{:>10} {:<9}{:>12.1f}{:>12.1f}{:>8.2f}{:>9.0f}{:>10}\n", c.name, c.vertices,
                 c.order, per_vertex(times.ours), per_vertex(times.baseline), ratio,
                 c.bytes_per_vertex, usage.ru_maxrss / 1024);
    }
    std::fflush(stdout);
  }

 private:
  const Settings& settings_;
};

/// A noisy torus of about n vertices.
IndexedMesh synthetic(std::size_t n) {
  const auto tube = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(n) / 2.0)));
  return with_normal_noise(torus(2 * tube, tube, 1.0, 0.4), 0.2, 1);
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

/// λ in mean edges, as a default run chooses it for this step.
double automatic_lambda(PackedFlow& flow) {
  const double bend = flow.bends(true).robust * 180.0 / 3.14159265358979;
  return lambda_of_feature_angle(std::clamp(3.0 * bend, 12.0, 30.0), 1.0);
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
    report_.line(named("weld"),
                 in_turn([this] { (void)weld_equal_positions(source_.positions); }, {}));
    report_.line(named("topology"), in_turn([this] { (void)TriangleMesh::build(source_); },
                                            [this] { (void)plain_topology(source_); }));
    report_.line(named("reorder"), in_turn([this] { const PackedMesh packed(mesh_); }, {}));
    PlainFlow plain(source_);
    step("amc_step", Method::anisotropic,
         [&](double lambda, double s) { plain.amc_step(lambda, s); });
    step("pmc_step", Method::anisotropic_prescribed,
         [&](double lambda, double s) { plain.pmc_step(lambda, s); });
    report_.line(named("curvature"),
                 in_turn([this] { (void)curvature(mesh_, mesh_.positions()); }, {}));
    total();
  }

 private:
  Case named(std::string name) const { return {std::move(name), mesh_.vertex_count(), order_}; }

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

  static void default_steps(PackedFlow& flow, int steps) {
    for (int i = 0; i < steps; ++i) {
      flow.step(automatic_lambda(flow), 0.1, 1e6);
      flow.displacement();
    }
  }

  /// The first steps of a default run, in turn with as many of the plain code at the final λ.
  void step(const std::string& name, Method method,
            const std::function<void(double, double)>& plain_step) const {
    const std::unique_ptr<PackedFlow> fresh = flow(method);
    std::vector<double> ours;
    std::vector<double> plain;
    const double s = 0.1 * mean_edge_ * mean_edge_;
    for (int i = 0; i < 5; ++i) {
      const std::unique_ptr<PackedFlow> run = flow(method);
      ours.push_back(seconds_of([&] { default_steps(*run, kSteps); }) / kSteps);
      const double lambda = automatic_lambda(*run) * mean_edge_;
      plain.push_back(seconds_of([&] {
                        for (int k = 0; k < 4; ++k) plain_step(lambda, s);
                      }) /
                      4.0);
    }
    Case c = named(name);
    c.bytes_per_vertex =
        static_cast<double>(fresh->kernel_bytes()) / static_cast<double>(c.vertices);
    report_.line(c, {median_of(ours), median_of(plain)});
  }

  /// Reordering and ten steps: what an arrangement of the input costs in the end.
  void total() const {
    report_.line(named("reorder+10amc"), in_turn(
                                             [this] {
                                               const std::unique_ptr<PackedFlow> run =
                                                   flow(Method::anisotropic);
                                               default_steps(*run, 10);
                                             },
                                             {}));
  }

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
  app.add_option("--sizes", settings.sizes, "Numbers of vertices")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  const fairway::bench::Report report(settings);
  for (const std::size_t size : settings.sizes) {
    const fairway::IndexedMesh natural = fairway::bench::synthetic(size);
    fairway::bench::Bench(settings, report, natural, "natural").run();
    const fairway::IndexedMesh random = fairway::bench::shuffled(natural);
    fairway::bench::Bench(settings, report, random, "shuffled").run();
  }
  return 0;
}
