// Benchmarks of the way in and out: what reading, patching and writing cost beside a plain copy of
// the same bytes and beside bare libdraco, and a whole run of the tool beside its steps alone.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>

#include "core/curvature.h"
#include "core/packed_flow.h"
#include "core/shapes.h"
#include "core/surface_geometry.h"
#include "proto/formats/fresh_mesh.h"
#include "server/os/child_process.h"
#include "server/os/file.h"
#include "server/os/memory.h"
#include "tests/bench/default_step.h"
#include "tests/bench/draco_baseline.h"
#include "tests/bench/plain_flow.h"
#include "tests/bench/report.h"
#include "tests/service/support/temporary_directory.h"

namespace fairway::bench {
namespace {

using Bytes = std::vector<std::byte>;

/// Enough for both sides to meet the same quiet moments of a machine.
constexpr int kRuns = 15;
constexpr int kShortRuns = 51;
constexpr int kSteps = 10;

Surface synthetic(std::size_t n) {
  const auto tube = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(n) / 2.0)));
  Surface out;
  out.name = "meshes/0";
  out.mesh = with_normal_noise(torus(2 * tube, tube, 1.0, 0.4), 0.1, 1);
  return out;
}

/// A result with all attributes; which numbers they hold makes no difference to a copy.
SurfaceResult moved_result(const IndexedMesh& mesh) {
  SurfaceResult out;
  out.moved = true;
  out.positions = mesh.positions;
  const TriangleMesh surface = *TriangleMesh::build(mesh);
  const CurvatureFields k = curvature(surface, surface.positions());
  const auto add = [&out](const char* name, int components, const double* values,
                          std::size_t count) {
    out.attributes.push_back({name, components, std::vector<float>(values, values + count)});
  };
  const std::size_t n = mesh.positions.size();
  add("_CURVATURE_K1", 1, k.k1.data(), n);
  add("_CURVATURE_K2", 1, k.k2.data(), n);
  add("_CURVATURE_MEAN", 1, k.mean.data(), n);
  add("_CURVATURE_GAUSSIAN", 1, k.gaussian.data(), n);
  add("_CURVATURE_PREDOMINANT", 1, k.predominant.data(), n);
  add("_CURVATURE_DIR1", 3, k.dir1.data()->data(), 3 * n);
  add("_CURVATURE_DIR2", 3, k.dir2.data()->data(), 3 * n);
  return out;
}

Bytes join(const ByteChain& chain) {
  return chain.joined();
}

class WireBench {
 public:
  WireBench(std::size_t vertices, bool json)
      : surface_(synthetic(vertices)), result_(moved_result(surface_.mesh)), json_(json) {}

  void run() {
    glb();
    draco();
    whole();
  }

 private:
  std::size_t vertices() const { return surface_.mesh.positions.size(); }

  static constexpr double kNoLimit = 0.0;

  /// One measure with its limit: ours ÷ baseline.
  void line(const std::string& name, double ours, double baseline, double limit) const {
    const double ratio = ours / baseline;
    if (json_) {
      fmt::print(R"({{"name":"{}","vertices":{},"ms":{:.3f},"baseline_ms":{:.3f},"ratio":{:.3f},)"
                 R"("limit":{}}})"
                 "\n",
                 name, vertices(), 1e3 * ours, 1e3 * baseline, ratio, limit);
    } else {
      fmt::print("{:<28}{:>9}{:>12.2f}{:>14.2f}{:>9.2f}{:>8}\n", name, vertices(), 1e3 * ours,
                 1e3 * baseline, ratio, limit == kNoLimit ? "-" : fmt::to_string(limit));
    }
    std::fflush(stdout);
  }

  /// What `use` makes of the written pieces, which live as long as the document.
  template <class Use>
  auto decode_and_encode(const Bytes& file, Format format, const Use& use) const {
    const auto document = decode(file, format);
    const std::vector<SurfaceResult>& results = results_;
    const auto out = convert(**document, results, {format, format, encoding_});
    return use(out->bytes);
  }

  /// Against copying the file and the new accessors behind it: up to the pieces that the tool and
  /// the worker hand to the system, and with the copy that joins them in memory.
  void glb() {
    const Bytes file = write_fresh_mesh(surface_, {}, Format::glb, encoding_)->bytes.joined();
    results_ = {result_};
    std::vector<float> positions;
    for (const Vec3& p : result_.positions) {
      for (int c = 0; c < 3; ++c) positions.push_back(static_cast<float>(p[c]));
    }
    const auto copy = [&] {
      Bytes out;
      std::size_t size = file.size() + positions.size() * sizeof(float);
      for (const VertexAttribute& a : result_.attributes) size += a.values.size() * sizeof(float);
      out.reserve(size);
      out.insert(out.end(), file.begin(), file.end());
      const auto append = [&out](const std::vector<float>& values) {
        const auto bytes = std::as_bytes(std::span(values));
        out.insert(out.end(), bytes.begin(), bytes.end());
      };
      append(positions);
      for (const VertexAttribute& a : result_.attributes) append(a.values);
    };
    const auto size = [](const ByteChain& chain) { return chain.size(); };
    const Times pieces = in_turn(
        kShortRuns, [&] { (void)decode_and_encode(file, Format::glb, size); }, copy);
    line("glb / memcpy", pieces.ours, pieces.baseline, 3.0);
    const Times joined = in_turn(
        kShortRuns, [&] { (void)decode_and_encode(file, Format::glb, join); }, copy);
    line("glb, joined / memcpy", joined.ours, joined.baseline, kNoLimit);
  }

  void draco() {
    const Bytes file = write_fresh_mesh(surface_, {}, Format::drc, encoding_)->bytes.joined();
    results_ = {result_};
    const Bytes written = decode_and_encode(file, Format::drc, join);
    const DracoBaseline bare(file, written, encoding_.draco);
    std::size_t bare_size = 0;
    const Times times = in_turn(
        kRuns, [&] { (void)decode_and_encode(file, Format::drc, join); },
        [&] { bare_size = bare.run(); });
    line("draco / bare libdraco", times.ours, times.baseline, 1.4);
    if (!json_) fmt::print("  {} bytes, bare {}\n", written.size(), bare_size);
  }

  /// Ten default steps in the packed kernels alone.
  double kernel_steps() const {
    const TriangleMesh mesh = *TriangleMesh::build(surface_.mesh);
    const std::vector<unsigned char> held(mesh.vertex_count(), 0);
    FlowOptions options;
    options.method = Method::anisotropic;
    const auto flow =
        PackedFlow::create(mesh, mesh.positions(), mesh.mean_edge_length(), held, options, {});
    flow->mark_start();
    return seconds_of([&] {
      for (int i = 0; i < kSteps; ++i) default_step(*flow);
    });
  }

  double plain_steps(PlainFlow& plain) const {
    const double mean_edge = TriangleMesh::build(surface_.mesh)->mean_edge_length();
    plain.set_positions(surface_.mesh.positions);
    return seconds_of([&] {
      for (int i = 0; i < kSteps; ++i) {
        plain.amc_step(0.5 * mean_edge, kStepSize * mean_edge * mean_edge);
      }
    });
  }

  /// A run of the tool as a process, and what it says of its stages.
  double tool_run(const std::filesystem::path& folder, std::string& stages) const {
    const std::filesystem::path out = folder / "out.glb";
    const std::filesystem::path log = folder / "log";
    std::filesystem::remove(out);
    std::filesystem::remove(log);
    const auto null = open_file("/dev/null", O_RDONLY);
    const auto text = open_file(log, O_RDWR | O_CREAT | O_APPEND);
    const double time = seconds_of([&] {
      auto child =
          ChildProcess::spawn({.program = FAIRWAY_TOOL,
                               .arguments = {"denoise", "-q", "--timings", folder / "in.glb", out,
                                             "--params", R"({"steps":10,"method":"anisotropic"})"},
                               .environment = {},
                               .descriptors = {null->get(), text->get(), text->get()}});
      (void)child->wait();
    });
    std::ifstream in(log);
    stages.assign(std::istreambuf_iterator<char>(in), {});
    return std::filesystem::exists(out) ? time : std::numeric_limits<double>::quiet_NaN();
  }

  void whole() const {
    const test::TemporaryDirectory folder;
    const Bytes file = write_fresh_mesh(surface_, {}, Format::glb, encoding_)->bytes.joined();
    std::ofstream(folder.path() / "in.glb", std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()),
               static_cast<std::streamsize>(file.size()));
    PlainFlow plain(surface_.mesh);
    double tool = std::numeric_limits<double>::max();
    double kernel = tool;
    double halfedge = tool;
    std::string stages;
    for (int i = 0; i < kRuns; ++i) {
      std::string said;
      const double time = tool_run(folder.path(), said);
      if (!(time >= tool)) stages = said;
      tool = std::isnan(time) ? time : std::min(tool, time);
      kernel = std::min(kernel, kernel_steps());
      halfedge = std::min(halfedge, plain_steps(plain));
    }
    line("fairway denoise / steps", tool, kernel, 6.0);
    line("fairway denoise / halfedges", tool, halfedge, 0.35);
    if (!json_) fmt::print("  {}", stages);
  }

  const Surface surface_;
  const SurfaceResult result_;
  const bool json_;
  const Encoding encoding_;
  std::vector<SurfaceResult> results_;
};

}  // namespace
}  // namespace fairway::bench

int main(int argc, char** argv) {
  bool json = false;
  std::vector<std::size_t> sizes = {130'000, 1'000'000};
  CLI::App app("Benchmarks of reading and writing", "wire_bench");
  app.add_flag("--json", json, "One JSON line per case");
  app.add_option("--sizes", sizes, "Numbers of vertices")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  // As the worker does.
  const std::size_t largest = *std::max_element(sizes.begin(), sizes.end());
  fairway::prepare_heap(fairway::heap_estimate(36 * largest));
  if (!json) {
    fmt::print("{:<28}{:>9}{:>12}{:>14}{:>9}{:>8}\n", "measure", "vertices", "ms", "baseline ms",
               "ratio", "limit");
  }
  for (const std::size_t size : sizes) fairway::bench::WireBench(size, json).run();
  return 0;
}
