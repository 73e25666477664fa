// The tool: denoise a file by hand, make and compare samples, work for fairwayd.

#include <cstdio>
#include <exception>
#include <functional>
#include <new>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "proto/messages/problem.h"
#include "server/fairway/commands.h"

namespace fairway {
namespace {

/// The whole command line. Each verb sets what is to be done.
class Tool {
 public:
  Tool() {
    app_.require_subcommand(1);
    app_.set_version_flag("--version", std::string("fairway ") + FAIRWAY_VERSION);
    add_denoise();
    add_curvature();
    add_inspect();
    add_methods();
    add_sample();
    add_compare();
    add_submit();
    add_worker();
  }

  int run(int argc, char** argv) {
    // Its options are not ours to parse.
    if (argc > 1 && argv[1] == std::string_view("submit")) return tell(run_submit(argv + 2));
    try {
      app_.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
      const int code = app_.exit(e, std::cout, std::cerr);
      return code == 0 ? 0 : problem_kind(ErrorCode::usage).exit_code;
    }
    return verb_();
  }

 private:
  /// Runs a command and says what went wrong, if anything did.
  template <class Command>
  std::function<void()> choose(const Command& command) {
    return [this, &command] { verb_ = [&command] { return tell(fairway::run(command)); }; };
  }

  /// The exit code of what was done.
  static int tell(const Result<void>& done) {
    if (done) return 0;
    const ProblemKind& kind = problem_kind(done.error().code);
    const std::string where =
        done.error().pointer.empty() ? "" : fmt::format(" (at {})", done.error().pointer);
    fmt::print(stderr, "fairway: {}: {}{}\n", kind.title, done.error().message, where);
    return kind.exit_code;
  }

  /// A verb that makes a file of a file.
  template <class Command>
  void add_file_verb(const char* name, const char* what, const char* parameters, Command& command) {
    CLI::App* verb = app_.add_subcommand(name, what);
    verb->add_option("IN", command.input,
                     "GLB, glTF (with the files beside it), Draco, PLY, OBJ or STL file")
        ->required();
    verb->add_option("OUT", command.output,
                     "Result; the extension chooses .glb, .gltf, .drc, .ply, .obj or .stl")
        ->required();
    verb->add_option("--params", command.parameters, parameters);
    verb->add_flag("--quiet,-q", command.quiet, "Print errors only");
    verb->add_flag("--timings", command.timings, "Print how long each stage took");
    verb->callback(choose(command));
  }

  void add_denoise() {
    add_file_verb("denoise", "Remove noise from a mesh and add curvature",
                  "Parameters: JSON text or a file that holds it", denoise_);
  }

  void add_curvature() {
    add_file_verb("curvature", "Add curvature per vertex; nothing moves",
                  "Parameters: JSON text or a file that holds it; curvature, features, "
                  "feature_angle, lambda, guards and output count, the flow's others do not",
                  curvature_);
  }

  void add_inspect() {
    CLI::App* verb = app_.add_subcommand(
        "inspect", "Tell what a file holds and what a run would meet; changes nothing");
    verb->add_option("FILE", inspect_.input,
                     "GLB, glTF (with the files beside it), Draco, PLY, OBJ or STL file")
        ->required();
    verb->add_flag("--json", inspect_.json, "Print a JSON document instead of a table");
    verb->callback(choose(inspect_));
  }

  void add_methods() {
    CLI::App* verb = app_.add_subcommand("methods", "List the flows, presets and parameters");
    verb->add_flag("--json", methods_.json, "Print a JSON document instead of tables");
    verb->callback(choose(methods_));
  }

  void add_sample() {
    CLI::App* verb = app_.add_subcommand("sample", "Make a noisy mesh to try things on");
    verb->add_option("SHAPE", sample_.shape, "ring, sphere, octahedron, torus or sheet")
        ->required();
    verb->add_option("OUT", sample_.output,
                     "File to write; the extension chooses .glb, .gltf, .drc, .ply, .obj or .stl")
        ->required();
    verb->add_option("--clean", sample_.clean, "Also write the mesh without noise to this file");
    verb->add_option("--size", sample_.size, "Resolution; every shape has a default");
    verb->add_option("--noise", sample_.noise, "Standard deviation in mean edge lengths")
        ->check(CLI::Range(0.0, 10.0))
        ->capture_default_str();
    verb->add_option("--seed", sample_.seed, "Seed of the noise")->capture_default_str();
    verb->callback(choose(sample_));
  }

  void add_compare() {
    CLI::App* verb =
        app_.add_subcommand("compare", "Mean angle between the face normals of two meshes");
    verb->add_option("REFERENCE", compare_.reference, "The clean mesh")->required();
    verb->add_option("MESH", compare_.mesh, "A mesh with the same triangles")->required();
    verb->callback(choose(compare_));
  }

  /// For the help; run() never gets here with it.
  void add_submit() {
    app_.add_subcommand("submit",
                        "Denoise many files by a fairway server and resume what broke off "
                        "(fairway submit --help)");
  }

  void add_worker() {
    CLI::App* verb = app_.add_subcommand("worker", "One job of fairwayd; not for people");
    verb->add_option("--address-space", worker_.address_space, "Limit in bytes; 0 = none");
    verb->add_option("--cpu-seconds", worker_.cpu_seconds, "Limit in seconds; 0 = none");
    verb->add_flag_callback(
        "--self-test-sandbox", [this] { worker_.self_test = SelfTest::confined; },
        "Show that forbidden calls end a worker and that its work does not need them");
    verb->add_flag_callback(
            "--self-test-unconfined", [this] { worker_.self_test = SelfTest::unconfined; },
            "The same without walls, which must fail")
        ->group("");
    verb->callback([this] { verb_ = [this] { return fairway::run(worker_); }; });
  }

  CLI::App app_{"fairway: mesh denoising by anisotropic curvature flows", "fairway"};
  DenoiseCommand denoise_;
  CurvatureCommand curvature_;
  InspectCommand inspect_;
  MethodsCommand methods_;
  SampleCommand sample_;
  CompareCommand compare_;
  WorkerCommand worker_;
  std::function<int()> verb_;
};

}  // namespace
}  // namespace fairway

int main(int argc, char** argv) {
  try {
    return fairway::Tool().run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("fairway: there is not enough memory; use a smaller mesh\n", stderr);
    return fairway::problem_kind(fairway::ErrorCode::memory_limit).exit_code;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "fairway: %s\n", e.what());
    return fairway::problem_kind(fairway::ErrorCode::internal).exit_code;
  }
}
