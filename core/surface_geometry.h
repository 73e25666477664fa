#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"
#include "core/triangle_mesh.h"

namespace fairway {

// Quantities of faces and vertices; `core/EQUATIONS.md` has symbols, units and signs in one table.
// `positions`: one per surface vertex, relative to the surface's origin.

/// Mean length L over all edges, boundary included.
double mean_edge_length(const TriangleMesh& mesh, std::span<const Vec3> positions);

/// Faces below this area (length²) count as absent: 1e-12 L².
constexpr double smallest_area(double mean_edge) {
  return 1e-12 * mean_edge * mean_edge;
}

/// Unit outward normals and areas (length²) of faces; both zero for an absent face.
struct FaceGeometry {
  std::vector<Vec3> normals;
  std::vector<double> areas;

  bool present(Index face) const { return areas[face] > 0.0; }
};
FaceGeometry face_geometry(const TriangleMesh& mesh, std::span<const Vec3> positions,
                           double smallest_area);

/// Lumped mass M_pp = area(star p)/3, length²; after (7). Sums to the area.
std::vector<double> lumped_mass(const TriangleMesh& mesh, const FaceGeometry& faces);

/// Mixed Voronoi area, length² (Meyer, Desbrun, Schröder, Barr 2003). Sums to the area.
std::vector<double> mixed_area(const TriangleMesh& mesh, std::span<const Vec3> positions,
                               const FaceGeometry& faces);

/// Area-weighted mean of the face normals, unit, outward; zero where no face is present.
std::vector<Vec3> vertex_normals(const TriangleMesh& mesh, const FaceGeometry& faces);

/// Gradient of the enclosed volume, ⅓ Σ area_T N_T over the star, length², outward; before (10).
std::vector<Vec3> volume_gradient(const TriangleMesh& mesh, const FaceGeometry& faces);

/// Integrated Gaussian curvature: 2π − Σ angles, at boundary vertices π − Σ angles. Sums to 2πχ.
std::vector<double> angle_defect(const TriangleMesh& mesh, std::span<const Vec3> positions,
                                 const FaceGeometry& faces);

/// Sum of the face areas, length².
double surface_area(const FaceGeometry& faces);

/// Signed volume about the origin, length³; for an open surface that of the cone over it.
double enclosed_volume(const TriangleMesh& mesh, std::span<const Vec3> positions);

/// What a flow did to a surface as a whole.
struct SurfaceChange {
  double volume_before = 0.0;  ///< as enclosed_volume()
  double volume_after = 0.0;
  double area_before = 0.0;  ///< of the faces present, length²
  double area_after = 0.0;
  std::size_t flipped_faces = 0;  ///< faces that turned by more than 90°
};

/// In one walk over the faces.
SurfaceChange surface_change(const TriangleMesh& mesh, std::span<const Vec3> before,
                             std::span<const Vec3> after, double smallest_area);

/// Angle at `at` between the directions to `a` and `b`, radians in [0, π].
double angle_at(const Vec3& at, const Vec3& a, const Vec3& b);

/// Cotangent of that angle; `twice_area` = |(a − at) × (b − at)| > 0.
inline double cotangent_at(const Vec3& at, const Vec3& a, const Vec3& b, double twice_area) {
  return (a - at).dot(b - at) / twice_area;
}

}  // namespace fairway
