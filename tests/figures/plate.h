#pragma once

#include <functional>
#include <vector>

#include "core/mesh.h"
#include "tests/figures/delaunay.h"

namespace fairway {

/// A region of the plane to be cut into nearly equilateral triangles. `loops`: closed boundaries
/// with the region on their left (outline counter-clockwise, holes clockwise); `creases`: open
/// lines inside that edges must follow. All are sampled about `spacing` apart.
struct PlanarRegion {
  std::vector<std::vector<Vec2>> loops;
  std::vector<std::vector<Vec2>> creases;
  double spacing = 0.0;
};

/// Vertices: those of the loops in their order, of the creases, then the rest.
struct PlanarMesh {
  std::vector<Vec2> points;
  std::vector<Triangle> triangles;
};
PlanarMesh triangulate(const PlanarRegion& region);

/// The closed, outward oriented solid over `region` between the plane z = `bottom` and the height
/// `top`, its walls cut in triangles of the same size. Corners of the loops become edges.
IndexedMesh extrude(const PlanarRegion& region, const std::function<double(const Vec2&)>& top,
                    double bottom);

/// Points about `spacing` apart on the segment from a to b, without b, in an even number of steps.
std::vector<Vec2> segment(const Vec2& a, const Vec2& b, double spacing);

/// The same on an arc about the origin, from angle `from` to `to` (radians; clockwise if smaller).
std::vector<Vec2> arc(double radius, double from, double to, double spacing);

}  // namespace fairway
