// `fairway denoise` and `fairway curvature`: the pipeline by hand, with a progress bar on a
// terminal.

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "proto/messages/parameters.h"
#include "server/fairway/commands.h"
#include "server/fairway/input_file.h"
#include "server/fairway/pipeline.h"
#include "server/fairway/side_folder.h"
#include "server/fairway/stage_times.h"
#include "server/os/memory.h"

namespace fairway {
namespace {

Result<Parameters> read_parameters(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || text[first] == '{') return parse_parameters(text);
  const Result<InputFile> file = InputFile::open(text);
  if (!file) return file.error();
  const auto bytes = file->bytes();
  return parse_parameters({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// The output format that parameters and file name agree on.
Result<void> choose_output(const std::string& file_name, Parameters& parameters) {
  const Result<Format> named = format_of_output(file_name);
  if (!named) return named.error();
  if (parameters.output && *parameters.output != *named) {
    return Error{ErrorCode::usage, fmt::format("The parameters ask for {}, the file name for {}.",
                                               name_of(*parameters.output), name_of(*named))};
  }
  parameters.output = *named;
  return {};
}

void draw_bar(const Progress& progress) {
  constexpr int kWidth = 30;
  const int filled = static_cast<int>(std::lround(progress.fraction * kWidth));
  std::string bar(static_cast<std::size_t>(filled), '#');
  bar.resize(kWidth, '.');
  const std::string steps =
      progress.of > 0 ? fmt::format(" {}/{}", progress.step, progress.of) : std::string();
  fmt::print(stderr, "\r[{}] {:3.0f} %  {}{}\033[K", bar, 100.0 * progress.fraction, progress.stage,
             steps);
  std::fflush(stderr);
}

std::string variational_summary(const FlowReport& flow) {
  const std::string_view noise =
      flow.noise_kind == FoundNoise::correlated ? "noise that neighbours share, " : "";
  if (flow.pass_band > 0.0) {
    return fmt::format("{}low pass {:.2f} beside {} steps", noise, flow.pass_band,
                       flow.steps.size());
  }
  return fmt::format("{}step {} of {} chosen, strength {:.2f}", noise, flow.chosen_step,
                     flow.steps.size(), flow.strength);
}

void print_report(const JobReport& report) {
  for (const SurfaceReport& surface : report.surfaces) {
    const FlowReport& flow = surface.flow;
    fmt::print("{}: {} vertices, {} faces, noise about {:.3f} mean edge lengths\n", surface.name,
               surface.vertices, surface.faces, flow.noise);
    if (flow.method == Method::variational && !flow.steps.empty()) {
      fmt::print("  {}, moved {:.3f} mean edges (rms)\n", variational_summary(flow),
                 flow.rms_displacement);
    } else if (!flow.steps.empty()) {
      fmt::print(
          "  {} steps of {:.3g}, feature angle {:.1f} degrees, moved {:.3f} mean edges (rms)\n",
          flow.steps.size(), flow.step_size, flow.steps.back().feature_angle,
          flow.rms_displacement);
    } else if (flow.feature_angle > 0.0) {
      fmt::print("  features from {:.1f} degrees on\n", flow.feature_angle);
    }
    if (!flow.steps.empty() && surface.boundary_loops == 0 && flow.volume_before != 0.0) {
      fmt::print("  volume {:+.3f} %\n", 100.0 * (flow.volume_after / flow.volume_before - 1.0));
    }
    for (const std::string& note : flow.notes) fmt::print("  {}\n", note);
  }
  for (const std::string& note : report.notes) fmt::print("{}\n", note);
}

Result<void> run_by_hand(const DenoiseCommand& command, Parameters parameters) {
  if (Result<void> chosen = choose_output(command.output, parameters); !chosen) return chosen;
  StageTimes times;
  const Result<InputFile> input = InputFile::open(command.input);
  if (!input) return input.error();
  const auto head = input->bytes().first(std::min(input->bytes().size(), kMagicBytes));
  const Result<Format> format = recognise_format(head, "", command.input);
  if (!format) return format.error();

  prepare_heap(heap_estimate(input->bytes().size()));
  SideFolder files(command.input);
  const bool bar = !command.quiet && isatty(STDERR_FILENO) != 0;
  const auto observer = [bar, &times](const Progress& progress) {
    times.begin(progress.stage);
    if (bar) draw_bar(progress);
  };
  const Result<PipelineOutput> output =
      run_pipeline(input->bytes(), *format, parameters, observer, {}, files.provider());
  if (bar) fmt::print(stderr, "\r\033[K");
  if (!output) return output.error();
  times.begin("write");
  if (Result<void> written = write_file(command.output, output->bytes); !written) return written;
  if (command.timings) times.print();
  if (!command.quiet) print_report(output->report);
  return {};
}

}  // namespace

Result<void> run(const DenoiseCommand& command) {
  Result<Parameters> parameters = read_parameters(command.parameters);
  if (!parameters) return parameters.error();
  return run_by_hand(command, *std::move(parameters));
}

Result<void> run(const CurvatureCommand& command) {
  Result<Parameters> parameters = read_parameters(command.parameters);
  if (!parameters) return parameters.error();
  parameters->flow.method = Method::none;
  return run_by_hand({command.input, command.output, {}, command.quiet, command.timings},
                     *std::move(parameters));
}

}  // namespace fairway
