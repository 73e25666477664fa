#pragma once

#include <cstdint>

#include "core/mesh.h"

namespace fairway {

// Generated shapes for samples, tests and benchmarks. Closed shapes are outward oriented.

/// The paper's Fig. 5: a torus of square section around the z axis, tube radius 1, section side
/// 0.44, with curved features. `around` segments, 2 `side` segments per side of the section: around
/// · 8 side vertices. around ≈ 31 side makes the triangles nearly equilateral. Needs around ≥ 3,
/// side ≥ 1.
IndexedMesh ring(Index around, Index side);

/// Icosahedron subdivided `levels` times on a sphere about the origin: 10 · 4^levels + 2 vertices.
IndexedMesh sphere(Index levels, double radius);

/// Regular octahedron of circumradius 1, its faces cut n × n: 4 n² + 2 vertices.
IndexedMesh octahedron(Index n);

/// Smooth torus about the z axis: `around` × `tube` vertices.
IndexedMesh torus(Index around, Index tube, double major_radius, double minor_radius);

/// Open square [−1, 1]² in the plane z = 0, (n + 1)² vertices, normals +z.
IndexedMesh sheet(Index n);

/// The mesh with Gaussian noise along its vertex normals, `strength` in mean edge lengths.
/// Deterministic for a seed on every platform.
IndexedMesh with_normal_noise(const IndexedMesh& mesh, double strength, std::uint64_t seed);

/// Mean angle between corresponding face normals of two meshes with the same triangles, degrees,
/// unweighted: the usual measure of a denoised mesh against the clean one. Faces without area in
/// either mesh count as 90°.
double mean_normal_error(const IndexedMesh& reference, const IndexedMesh& mesh);

}  // namespace fairway
