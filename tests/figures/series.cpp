// Figures of one model, panel by panel.

#include "tests/figures/series.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/shapes.h"
#include "tests/figures/measures.h"

namespace fairway {
namespace {

constexpr std::uint64_t kSeed = 1;
const Scale kCurvatureScale = {1.6, "|k| L"};

}  // namespace

Series::Series(std::string name, IndexedMesh clean, double noise, const Vec3& direction,
               const Vec3& up)
    : clean_(std::move(clean)), noisy_(with_normal_noise(clean_, noise, kSeed)) {
  figure_.name = std::move(name);
  look(direction, up);
}

void Series::look(const Vec3& direction, const Vec3& up) {
  figure_.camera = camera_for(clean_, direction, up,
                              static_cast<double>(figure_.panel_width) / figure_.panel_height);
}

Result<void> Series::add(std::string title, IndexedMesh mesh) {
  Result<std::vector<double>> values = relative_curvature(mesh);
  if (!values) return values.error();
  std::string note = fmt::format("{:.2f} deg, volume {:+.2f} %", mean_normal_error(clean_, mesh),
                                 100.0 * (volume_of(mesh) / volume_of(clean_) - 1.0));
  figure_.panels.push_back({std::move(title),
                            std::move(note),
                            std::move(mesh),
                            *std::move(values),
                            kCurvatureScale,
                            {}});
  return {};
}

Result<void> Series::add_clean() {
  Result<void> done = add("original", clean_);
  if (done) figure_.panels.back().note = fmt::format("{} vertices", clean_.positions.size());
  return done;
}

Result<void> Series::add_noisy() {
  return add("noisy", noisy_);
}

Result<void> Series::add_flow(std::string title, const FlowOptions& options) {
  Result<IndexedMesh> mesh = after_flow(noisy_, options);
  if (!mesh) return mesh.error();
  return add(std::move(title), *std::move(mesh));
}

Result<void> all_of(std::initializer_list<Result<void>> done) {
  for (const Result<void>& one : done) {
    if (!one) return one;
  }
  return {};
}

}  // namespace fairway
