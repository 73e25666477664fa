// Tangents beside moved normals. Source: glTF 2.0 section 3.7.2.1.

#include "proto/formats/gltf_tangents.h"

#include <Eigen/Geometry>

#include "proto/formats/gltf_accessor.h"

namespace fairway {
namespace {

/// The tangent of glTF (w is the handedness) made perpendicular to a new normal.
void straighten(const Vec3& normal, double* tangent) {
  Vec3 t(tangent[0], tangent[1], tangent[2]);
  t -= normal * normal.dot(t);
  if (!(t.norm() > 1e-12)) {
    Eigen::Index smallest = 0;
    normal.cwiseAbs().minCoeff(&smallest);
    t = normal.cross(Vec3::Unit(smallest));
  }
  if (!(t.norm() > 0.0)) t = Vec3::UnitX();
  t.normalize();
  for (int c = 0; c < 3; ++c) tangent[c] = t[c];
}

Result<std::vector<double>> old_tangents(const GltfTables& tables, const DracoMeshes& draco,
                                         const TriangleSource& source, std::size_t accessor) {
  if (!source.draco || !source.draco->ids.contains("TANGENT")) {
    return read_values(tables, accessor);
  }
  const DracoMesh& mesh = draco.at(source.draco->view);
  const std::uint64_t id = source.draco->ids.find("TANGENT")->second;
  return draco_values(mesh, *mesh.find_unique(id), tables.accessors[accessor]);
}

}  // namespace

Result<PackedValues> straight_tangents(const GltfTables& tables, const DracoMeshes& draco,
                                       const TriangleSource& source, std::size_t accessor,
                                       std::span<const Vec3> normals) {
  auto tangents = old_tangents(tables, draco, source, accessor);
  if (!tangents) return tangents.error();
  for (std::size_t i = 0; i < normals.size(); ++i) {
    straighten(normals[i], tangents->data() + 4 * i);
  }
  return pack_values(*tangents, {ComponentType::f32, false, 4});
}

}  // namespace fairway
