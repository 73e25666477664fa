#pragma once

#include "core/mesh.h"

namespace fairway {

// The generated models of the figures, beside those of core/shapes.h. All are deterministic; the
// closed ones are outward oriented.

/// A square plate [−1, 1]² × [−0.4, 0.4] with a round hole of radius 0.6 through it, genus 1, with
/// nearly equilateral triangles of side `spacing`. The rims of the hole are curved features.
IndexedMesh drilled_block(double spacing);

/// A fan-shaped block (a sector of an annulus of radii 0.5 and 1.5, 130°) whose top has a ridge
/// along the arc of radius 1. Its crease angle fades smoothly from 60° to none along the arc.
IndexedMesh vanishing_ridge(double spacing);

/// Exterior crease angle of that ridge in degrees at one of its points; 0 at all other points.
double vanishing_ridge_angle_at(const Vec3& p);

/// An open wavy sheet over [−1, 1]², (n + 1)² vertices, for what happens at boundaries.
IndexedMesh wavy_sheet(int n);

/// A stylised head, y up, face towards +z, about 2 high: an icosahedron cut n × n (10 n² + 2
/// vertices) on a star-shaped surface with brows, nose, mouth, ears and a neck cut flat. Closed.
IndexedMesh head(int n);

}  // namespace fairway
