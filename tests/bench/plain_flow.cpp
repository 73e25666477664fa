// Textbook halfedge code, the yardstick of the benchmarks.

#include "tests/bench/plain_flow.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Utils/PropertyManager.hh>
#include <algorithm>
#include <cmath>
#include <vector>

namespace fairway::bench {
namespace {

struct Traits : OpenMesh::DefaultTraitsDouble {
  FaceAttributes(OpenMesh::Attributes::Normal | OpenMesh::Attributes::Status);
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using Point = Mesh::Point;

Mesh build(const IndexedMesh& source) {
  Mesh mesh;
  mesh.reserve(source.positions.size(), 3 * source.positions.size(), source.triangles.size());
  for (const Vec3& p : source.positions) mesh.add_vertex(Point(p.x(), p.y(), p.z()));
  for (const auto& [a, b, c] : source.triangles) {
    mesh.add_face(mesh.vertex_handle(a), mesh.vertex_handle(b), mesh.vertex_handle(c));
  }
  return mesh;
}

}  // namespace

struct PlainFlow::State {
  explicit State(const IndexedMesh& source)
      : mesh(build(source)),
        term(mesh, "term"),
        strength(mesh, "strength"),
        area(mesh, "area"),
        curvature(mesh, "curvature"),
        direction(mesh, "direction"),
        value(mesh, "value"),
        averaged(mesh, "averaged"),
        star(mesh, "star"),
        feature(mesh, "feature") {}

  void faces() {
    for (const auto f : mesh.faces()) {
      auto h = f.halfedge();
      const Point a = mesh.point(h.from());
      const Point n = (mesh.point(h.to()) - a).cross(mesh.point(h.next().to()) - a);
      const double length = n.norm();
      area[f] = 0.5 * length;
      mesh.set_normal(f, length > 0.0 ? n / length : Point(0, 0, 0));
    }
  }

  void edges(double lambda) {
    for (const auto e : mesh.edges()) {
      const auto h = e.h0();
      term[e] = Point(0, 0, 0);
      strength[e] = 0.0;
      if (e.is_boundary()) continue;
      const Point along = mesh.point(h.to()) - mesh.point(h.from());
      const Point he = along.cross(mesh.normal(h.face()) - mesh.normal(h.opp().face()));
      const double a = he.norm();
      const double d = lambda - a;
      const double w = a <= lambda ? 1.0 : lambda * lambda / (10.0 * d * d + lambda * lambda);
      term[e] = he * w;
      strength[e] = a;
    }
  }

  double star_area(OpenMesh::SmartVertexHandle v) const {
    double sum = 0.0;
    for (const auto f : v.faces()) sum += area[f];
    return sum;
  }

  /// H_A, ∇vol, star areas and feature vertices.
  void curvatures(double lambda) {
    for (const auto v : mesh.vertices()) {
      Point sum(0, 0, 0);
      bool strong = false;
      for (const auto e : v.edges()) {
        sum += term[e];
        strong = strong || strength[e] > lambda;
      }
      curvature[v] = sum * 0.5;
      feature[v] = strong;
      Point volume(0, 0, 0);
      double areas = 0.0;
      for (const auto f : v.faces()) {
        volume += mesh.normal(f) * (area[f] / 3.0);
        areas += area[f];
      }
      direction[v] = volume;
      star[v] = areas;
    }
  }

  static double angle(const Point& at, const Point& a, const Point& b) {
    const Point u = a - at;
    const Point w = b - at;
    return std::atan2(u.cross(w).norm(), u.dot(w));
  }

  Point smoothed(OpenMesh::SmartVertexHandle v) const {
    Point sum(0, 0, 0);
    double weights = 0.0;
    for (const auto h : v.outgoing_halfedges()) {
      if (!feature[h.to()]) continue;
      double w = 0.0;
      const Point& p = mesh.point(v);
      const Point& q = mesh.point(h.to());
      if (!h.is_boundary()) w += angle(p, q, mesh.point(h.next().to()));
      if (!h.opp().is_boundary()) w += angle(p, q, mesh.point(h.opp().next().to()));
      sum += curvature[h.to()] * w;
      weights += w;
    }
    return weights > 0.0 ? (curvature[v] + sum / weights) * 0.5 : curvature[v];
  }

  void prescribe() {
    for (const auto v : mesh.vertices()) {
      Point d = direction[v];
      if (feature[v]) {
        const Point s = smoothed(v);
        const double length = s.norm();
        if (length > 1e-300) d = s.dot(d) < 0.0 ? s / -length : s / length;
      }
      const double length = d.norm();
      const double f = length > 0.0 ? curvature[v].norm() / length : 0.0;
      direction[v] = d;
      value[v] = curvature[v].dot(d) < 0.0 ? -f : f;
    }
    for (const auto v : mesh.vertices()) {
      double sum = 0.0;
      int count = 0;
      for (const auto q : v.vertices()) {
        if (feature[q] != feature[v]) continue;
        sum += value[q];
        ++count;
      }
      averaged[v] = count > 0 ? sum / count : value[v];
    }
  }

  Mesh mesh;
  OpenMesh::EProp<Point> term;
  OpenMesh::EProp<double> strength;
  OpenMesh::FProp<double> area;
  OpenMesh::VProp<Point> curvature;
  OpenMesh::VProp<Point> direction;
  OpenMesh::VProp<double> value;
  OpenMesh::VProp<double> averaged;
  OpenMesh::VProp<double> star;
  OpenMesh::VProp<bool> feature;
};

PlainFlow::PlainFlow(const IndexedMesh& mesh) : state_(std::make_unique<State>(mesh)) {}
PlainFlow::~PlainFlow() = default;

void PlainFlow::amc_step(double lambda, double s) {
  State& now = *state_;
  now.faces();
  now.edges(lambda);
  for (const auto v : now.mesh.vertices()) {
    Point sum(0, 0, 0);
    for (const auto e : v.edges()) sum += now.term[e];
    now.curvature[v] = sum * 0.5;
  }
  for (const auto v : now.mesh.vertices()) {
    const double star = now.star_area(v);
    if (star > 0.0) now.mesh.set_point(v, now.mesh.point(v) - now.curvature[v] * (3.0 * s / star));
  }
}

void PlainFlow::pmc_step(double lambda, double s) {
  State& now = *state_;
  now.faces();
  now.edges(lambda);
  now.curvatures(lambda);
  now.prescribe();
  for (const auto v : now.mesh.vertices()) {
    if (now.star[v] <= 0.0) continue;
    const Point velocity = now.curvature[v] - now.direction[v] * now.averaged[v];
    now.mesh.set_point(v, now.mesh.point(v) - velocity * (3.0 * s / now.star[v]));
  }
}

Vec3 PlainFlow::position(Index vertex) const {
  const Point& p = state_->mesh.point(state_->mesh.vertex_handle(vertex));
  return {p[0], p[1], p[2]};
}

void PlainFlow::set_positions(std::span<const Vec3> positions) {
  for (const auto v : state_->mesh.vertices()) {
    const Vec3& p = positions[static_cast<std::size_t>(v.idx())];
    state_->mesh.set_point(v, Point(p.x(), p.y(), p.z()));
  }
}

std::size_t plain_topology(const IndexedMesh& mesh) {
  return build(mesh).n_faces();
}

}  // namespace fairway::bench
