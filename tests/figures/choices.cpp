// The same noisy models with different parameters.

#include "tests/figures/choices.h"

#include <array>
#include <initializer_list>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/shapes.h"
#include "proto/messages/parameters.h"
#include "tests/figures/measures.h"
#include "tests/figures/models.h"
#include "tests/figures/series.h"

namespace fairway {
namespace {

const Vec3 kAbove = {-0.35, 0.55, -1.0};
const Vec3 kFace = {-0.35, -0.08, -1.0};
constexpr double kFaceMost = 0.8;

/// A panel for each document of parameters, whose title is the document.
Result<void> add_all(Series& series, std::initializer_list<const char*> documents) {
  for (const char* document : documents) {
    const Result<Parameters> parameters = parse_parameters(document);
    if (!parameters) return parameters.error();
    if (auto done = series.add_flow(document, parameters->flow); !done) return done;
  }
  return {};
}

/// Noisy first, then with each document.
Result<Figure> figure_of(Series series, std::initializer_list<const char*> documents) {
  if (auto done = series.add_noisy(); !done) return done.error();
  if (auto done = add_all(series, documents); !done) return done.error();
  return std::move(series.figure());
}

Result<Figure> part() {
  Series series("part", drilled_block(0.058), 0.2, kAbove, Vec3::UnitZ());
  series.figure().caption = "A drilled block of 5 052 vertices with noise of 0.2 L, by presets.";
  return figure_of(std::move(series), {"{}", R"({"preset": "cad"})", R"({"preset": "organic"})"});
}

Result<Figure> method() {
  Series series("method", ring(124, 6), 0.2, {-0.2, 0.75, -0.8}, Vec3::UnitZ());
  series.figure().caption = "A ring of 5 952 vertices with noise of 0.2 L, by method.";
  return figure_of(std::move(series),
                   {R"({"method": "variational"})", R"({"method": "anisotropic_prescribed"})",
                    R"({"method": "anisotropic"})", R"({"method": "mean_curvature"})"});
}

Result<Figure> feature_angle() {
  Series series("feature_angle", drilled_block(0.058), 0.2, kAbove, Vec3::UnitZ());
  series.figure().caption = "The drilled block again, by the flow's feature angle in degrees.";
  return figure_of(std::move(series),
                   {R"({"feature_angle": 5})", R"({"method": "anisotropic_prescribed"})",
                    R"({"feature_angle": 75})"});
}

/// The head by some parameter.
Result<Figure> face_by(const char* name, const char* caption,
                       std::initializer_list<const char*> documents) {
  Series series(name, head(60), 0.2, kFace, Vec3::UnitY());
  series.figure().caption = caption;
  Result<Figure> figure = figure_of(std::move(series), documents);
  if (!figure) return figure;
  for (Panel& panel : figure->panels) panel.scale.most = kFaceMost;
  return figure;
}

Result<Figure> face() {
  return face_by("face", "A head of 36 002 vertices with noise of 0.2 L, by presets.",
                 {"{}", R"({"preset": "organic"})", R"({"preset": "gentle"})"});
}

Result<Figure> strength() {
  return face_by("strength", "The head again, by strength.",
                 {R"({"strength": 0.2})", R"({"strength": "auto"})", R"({"strength": 0.8})"});
}

Result<Figure> steps() {
  return face_by(
      "steps", "The head again, by the flow's number of steps.",
      {R"({"method": "anisotropic", "steps": 3})", R"({"method": "anisotropic", "steps": "auto"})",
       R"({"method": "anisotropic", "steps": 300})"});
}

/// How far the boundary vertices of a mesh lie from those of another with the same triangles, in
/// mean edges.
double boundary_shift(const IndexedMesh& from, const IndexedMesh& to) {
  const Result<TriangleMesh> surface = TriangleMesh::build(from);
  if (!surface) return 0.0;
  double sum = 0.0;
  int count = 0;
  for (std::size_t v = 0; v < from.positions.size(); ++v) {
    const Index at = surface->vertex_of_source()[v];
    if (at == kNoIndex || surface->boundary_vertex()[at] == 0) continue;
    sum += (to.positions[v] - from.positions[v]).norm();
    ++count;
  }
  return count == 0 ? 0.0 : sum / count / mean_edge_of(from);
}

Result<Figure> boundary() {
  Series series("boundary", wavy_sheet(40), 0.3, {0.15, 0.45, -0.75}, Vec3::UnitZ());
  series.figure().caption = "A sheet of 1 681 vertices with noise of 0.3 L and an open boundary.";
  const IndexedMesh noisy = series.noisy();
  const IndexedMesh clean = series.clean();
  Result<Figure> figure =
      figure_of(std::move(series), {R"({"boundary": "free"})", R"({"boundary": "fixed"})",
                                    R"({"method": "anisotropic", "boundary": "fixed"})"});
  if (!figure) return figure;
  for (Panel& panel : figure->panels) {
    panel.note =
        fmt::format("{:.2f} deg, boundary moved {:.2f} L", mean_normal_error(clean, panel.mesh),
                    boundary_shift(noisy, panel.mesh));
  }
  return figure;
}

constexpr std::array kChoices = {
    Experiment{"part", part},         Experiment{"face", face},
    Experiment{"method", method},     Experiment{"feature_angle", feature_angle},
    Experiment{"strength", strength}, Experiment{"steps", steps},
    Experiment{"boundary", boundary}};

}  // namespace

std::span<const Experiment> choices() {
  return kChoices;
}

}  // namespace fairway
