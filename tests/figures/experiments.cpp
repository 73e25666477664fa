// The experiments of Hildebrandt & Polthier 2004 on generated models.

#include "tests/figures/experiments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/shapes.h"
#include "tests/figures/measures.h"
#include "tests/figures/models.h"
#include "tests/figures/series.h"

namespace fairway {
namespace {

/// `feature_angle` in degrees; none: chosen in every step from what noise is left.
FlowOptions flow(Method method, int steps, std::optional<double> feature_angle) {
  FlowOptions options;
  options.method = method;
  options.steps = steps;
  options.step_size = 0.1;
  options.feature_angle = feature_angle;
  return options;
}

Result<Figure> drilled_hole() {
  Series series("fig1_block", drilled_block(0.058), 0.2, {-0.35, 0.55, -1.0}, Vec3::UnitZ());
  const Result<void> done =
      all_of({series.add_clean(), series.add_noisy(),
              series.add_flow("AMC, 100 steps", flow(Method::anisotropic, 100, {})),
              series.add_flow("PMC, 100 steps", flow(Method::anisotropic_prescribed, 100, {}))});
  if (!done) return done.error();
  series.figure().caption =
      "Curved features like those of the paper's Fig. 1: a drilled block, noise 0.2 L, 100 steps "
      "of "
      "both flows, step size 0.1, the feature angle chosen in every step. Both recover the "
      "straight "
      "edges. AMC contracts the rims of the hole, which closes it: the volume grows. PMC keeps "
      "them.";
  return std::move(series.figure());
}

/// The panel again, coloured by the distance to the octahedron it came from.
Panel distance_panel(const Panel& panel) {
  Panel out = panel;
  const double mean_edge = mean_edge_of(panel.mesh);
  out.values = distances(panel.mesh, octahedron(1));
  double sum = 0.0;
  for (double& value : out.values) sum += value /= mean_edge;
  out.title = "(c), distance to (a)";
  out.note =
      fmt::format("mean {:.3f} L, largest {:.2f} L", sum / static_cast<double>(out.values.size()),
                  *std::ranges::max_element(out.values));
  out.scale = {0.2, "dist/L"};
  return out;
}

Result<Figure> straight_edges() {
  Series series("fig2_octahedron", octahedron(32), 0.15, {-0.8, 0.45, -0.5}, Vec3::UnitZ());
  const Result<void> done =
      all_of({series.add_clean(), series.add_noisy(),
              series.add_flow("AMC, 40 steps", flow(Method::anisotropic, 40, 15.0))});
  if (!done) return done.error();
  Figure& figure = series.figure();
  figure.panels.push_back(distance_panel(figure.panels.back()));
  figure.caption =
      "The paper's Fig. 2: an octahedron, noise 0.15 L, 40 steps of AMC, step size 0.1, feature "
      "angle 15 degrees. The edges come back straight and sharp. (d) is (c) coloured by the "
      "distance "
      "of its vertices to the original surface in L.";
  return std::move(figure);
}

/// The boundary of an (n + 1) × (n + 1) grid.
std::vector<Vec3> grid_boundary(const IndexedMesh& mesh, int n) {
  std::vector<Vec3> out;
  const auto add = [&](int i, int j) {
    out.push_back(mesh.positions[static_cast<std::size_t>(i * (n + 1) + j)]);
  };
  for (int k = 0; k < n; ++k) add(k, 0);
  for (int k = 0; k < n; ++k) add(n, k);
  for (int k = n; k > 0; --k) add(k, n);
  for (int k = n; k >= 0; --k) add(0, k);
  return out;
}

Result<Figure> boundary() {
  constexpr int kSide = 40;
  Series series("fig4_boundary", wavy_sheet(kSide), 0.2, {0.15, 0.45, -0.75}, Vec3::UnitZ());
  const Result<void> done =
      all_of({series.add_clean(), series.add_noisy(),
              series.add_flow("edge normals, 50 steps", flow(Method::mean_curvature, 50, {})),
              series.add("cotangents, 50 steps", cotangent_flow(series.noisy(), 0.1, 50))});
  if (!done) return done.error();
  Figure& figure = series.figure();
  figure.caption =
      "The paper's Fig. 4: an open sheet, noise 0.2 L, 50 steps of the isotropic mean curvature "
      "flow, step size 0.1, both with the same limit of the step at every vertex. (c) has the mean "
      "curvature vector as a sum of edge normals, (d) by the cotangent formula, which differs at "
      "the boundary only and shrinks it. Black: the boundary of (a).";
  for (Panel& panel : figure.panels) {
    panel.note = fmt::format("area {:.3f}", area_of(panel.mesh));
    panel.line = grid_boundary(series.clean(), kSide);
  }
  return std::move(figure);
}

/// The paper's parameters, and its formulas without the guards around them.
FlowOptions ring_flow(Method method, int steps) {
  FlowOptions options = flow(method, steps, 35.0);
  options.guards = {.unfold = false, .min_component = 0, .local_step = false};
  return options;
}

Result<Figure> curved_edges() {
  Series series("fig5_ring", ring(124, 6), 0.2, {-0.2, 0.75, -0.8}, Vec3::UnitZ());
  const Result<void> done = all_of(
      {series.add_noisy(), series.add_flow("AMC, 50 steps", ring_flow(Method::anisotropic, 50)),
       series.add_flow("AMC, 200 steps", ring_flow(Method::anisotropic, 200)),
       series.add_flow("PMC, 50 steps", ring_flow(Method::anisotropic_prescribed, 50)),
       series.add_flow("PMC, 200 steps", ring_flow(Method::anisotropic_prescribed, 200))});
  if (!done) return done.error();
  series.figure().caption =
      "The paper's Fig. 5: a ring of 5 952 vertices, noise 0.2 L, with the paper's feature angle "
      "of "
      "35 degrees and step size 0.1, without guards. AMC contracts the round feature lines and "
      "loses the ring; PMC converges to it.";
  return std::move(series.figure());
}

/// Mean of a panel's values over the vertices of the ridge where its crease is of 10 to 40 degrees.
double mean_on_ridge(const IndexedMesh& clean, const Panel& panel) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t v = 0; v < clean.positions.size(); ++v) {
    const double angle = vanishing_ridge_angle_at(clean.positions[v]);
    if (angle < 10.0 || angle > 40.0) continue;
    sum += panel.values[v];
    ++count;
  }
  return sum / count;
}

Result<Figure> vanishing_edge() {
  Series series("fig6_ridge", vanishing_ridge(0.037), 0.1, {-0.25, 0.8, -0.9}, Vec3::UnitZ());
  const Result<void> done =
      all_of({series.add_clean(), series.add_noisy(),
              series.add_flow("AMC, 50 steps", flow(Method::anisotropic, 50, 20.0)),
              series.add_flow("PMC, 50 steps", flow(Method::anisotropic_prescribed, 50, 20.0))});
  if (!done) return done.error();
  Figure& figure = series.figure();
  for (Panel& panel : figure.panels) {
    panel.note =
        fmt::format("{:.2f} deg, ridge |k| L {:.2f}", mean_normal_error(series.clean(), panel.mesh),
                    mean_on_ridge(series.clean(), panel));
    panel.scale.most = 1.0;
  }
  figure.caption =
      "The paper's Fig. 6 on a fan-shaped part of 6 886 vertices, whose ridge bends by 60 degrees "
      "and fades to none along its arc. Noise 0.1 L, 50 steps of both flows, step size 0.1, "
      "feature "
      "angle 20 degrees. AMC flattens the ridge, PMC keeps it further into where it fades. Ridge: "
      "mean |k| L where the original bends by 10 to 40 degrees.";
  return std::move(figure);
}

Result<Figure> organic() {
  Series series("fig7_head", head(114), 0.2, {-0.35, -0.08, -1.0}, Vec3::UnitY());
  const Result<void> done =
      all_of({series.add_clean(), series.add_noisy(),
              series.add_flow("AMC, 40 steps", flow(Method::anisotropic, 40, {})),
              series.add_flow("AMC, 120 steps", flow(Method::anisotropic, 120, {}))});
  if (!done) return done.error();
  for (Panel& panel : series.figure().panels) panel.scale.most = 0.8;
  series.figure().caption =
      "The paper's Fig. 7 on a generated head of the size of its Venus, noise 0.2 L. AMC, step "
      "size "
      "0.1, the feature angle chosen in every step: (c) removes the noise, except for some on the "
      "neck, where triangles are long; (d) smooths further, and the eyes with it.";
  return std::move(series.figure());
}

Result<Figure> readme() {
  Series series("readme", drilled_block(0.058), 0.2, -Vec3::UnitZ(), Vec3::UnitY());
  series.figure().panel_width = 484;
  series.figure().panel_height = 362;
  series.figure().bare = true;
  series.look({-0.35, 0.55, -0.8}, Vec3::UnitZ());
  const Result<void> done =
      all_of({series.add_noisy(), series.add_flow("denoised", FlowOptions())});
  if (!done) return done.error();
  return std::move(series.figure());
}

constexpr std::array kExperiments = {
    Experiment{"fig1", drilled_hole},   Experiment{"fig2", straight_edges},
    Experiment{"fig4", boundary},       Experiment{"fig5", curved_edges},
    Experiment{"fig6", vanishing_edge}, Experiment{"fig7", organic},
    Experiment{"readme", readme}};

}  // namespace

std::span<const Experiment> experiments() {
  return kExperiments;
}

}  // namespace fairway
