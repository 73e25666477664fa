#pragma once

#include <span>
#include <vector>

#include "core/mesh.h"
#include "tests/figures/image.h"

namespace fairway {

/// An orthographic camera. What lies at `target` is in the middle of the picture; `direction`
/// looks from the eye to it, `up` points up in the picture (not parallel to `direction`).
struct Camera {
  Vec3 target = Vec3::Zero();
  Vec3 direction = -Vec3::UnitZ();
  Vec3 up = Vec3::UnitY();
  double half_height = 1.0;  ///< length that half the height of the picture shows
};

/// `flat`: one normal per triangle, every facet shows. `smooth`: vertex normals.
enum class Shading { flat, smooth };

/// Draws triangles with a depth buffer and a light at the camera, from both sides alike.
class Rasteriser {
 public:
  /// The picture is computed with `samples` × `samples` samples a pixel.
  Rasteriser(int width, int height, int samples, const Camera& camera);

  /// `colours`: one per vertex, interpolated over the triangles.
  void draw(const IndexedMesh& mesh, std::span<const Rgb> colours, Shading shading);

  /// Lines between successive points, in front of everything, `width` pixels wide.
  void draw_line(std::span<const Vec3> points, double width, Rgb colour);

  Image image() const { return shrunk(samples_, factor_); }

 private:
  struct Corner {
    Vec3 screen;  // x, y in samples, z depth away from the eye
    Vec3 colour;
    double light = 0.0;
  };
  Vec3 to_screen(const Vec3& p) const;
  double light_on(const Vec3& normal) const;
  void fill(const std::array<Corner, 3>& corners);

  int factor_;
  Image samples_;
  std::vector<double> depth_;
  Vec3 target_, right_, up_, forward_;
  double scale_;  // samples per length
};

}  // namespace fairway
