// Random meshes and options for the tests of what must hold for any input.

#include "tests/core/random_meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/core.h>

#include "core/shapes.h"
#include "tests/core/generated_meshes.h"

namespace fairway::test {
namespace {

IndexedMesh soup(Random& random) {
  IndexedMesh mesh;
  const std::size_t vertices = 3 + random.below(60);
  for (std::size_t i = 0; i < vertices; ++i) mesh.positions.push_back(random.in_cube());
  for (std::size_t i = 0, n = 1 + random.below(200); i < n; ++i) {
    mesh.triangles.push_back(
        {random.below(vertices), random.below(vertices), random.below(vertices)});
  }
  return mesh;
}

/// Aspect 1e6: areas near 1e-12 L² beside large ones.
IndexedMesh needles(Random& random) {
  IndexedMesh mesh = with_normal_noise(sheet(3 + random.below(8)), 0.1, random.below(1000));
  const double thin = std::pow(10.0, random.uniform(-13.0, -5.0));
  const bool all = random.chance(0.5);
  for (Vec3& p : mesh.positions) {
    if (all || p.x() > 0.0) p.x() *= thin;
  }
  return mesh;
}

/// Triangles of area 0 between the halves of split edges, as tessellators leave them.
IndexedMesh slivers(Random& random) {
  IndexedMesh mesh = with_normal_noise(octahedron(4 + random.below(10)), 0.1, random.below(1000));
  for (std::size_t f = 0, n = mesh.triangles.size(); f < n; ++f) {
    if (!random.chance(0.2)) continue;
    const auto [a, b, c] = mesh.triangles[f];
    const auto m = static_cast<Index>(mesh.positions.size());
    const double t = random.chance(0.5) ? 0.5 : random.uniform();
    mesh.positions.emplace_back((1.0 - t) * mesh.positions[a] + t * mesh.positions[b]);
    mesh.triangles[f] = {a, m, c};
    mesh.triangles.push_back({m, b, c});
    mesh.triangles.push_back({a, b, m});
  }
  return mesh;
}

/// A grid with whole coordinates: planes, exact zeros, everything coplanar.
IndexedMesh lattice(Random& random) {
  IndexedMesh mesh = soup(random);
  for (Vec3& p : mesh.positions) p = (2.0 * p).array().round();
  return mesh;
}

IndexedMesh wild_coordinates(Random& random) {
  IndexedMesh mesh = random.chance(0.5) ? soup(random) : sphere(2, 1.0);
  for (Vec3& p : mesh.positions) {
    for (double& c : p) c *= std::pow(10.0, random.uniform(-15.0, 15.0));
  }
  return mesh;
}

/// Many components, some far away, of sizes that differ by 1e±6.
IndexedMesh crowd(Random& random) {
  IndexedMesh mesh = scattered_tetrahedra(1 + random.below(60), 20.0, random.below(1000));
  for (std::size_t i = 0, n = random.below(4); i < n; ++i) {
    IndexedMesh other = with_normal_noise(sphere(1, 1.0), 0.2, random.below(1000));
    const double size = std::pow(10.0, random.uniform(-6.0, 6.0));
    for (Vec3& p : other.positions) p *= size;
    append(mesh, other, random.in_cube() * std::pow(10.0, random.uniform(0.0, 7.0)));
  }
  return mesh;
}

IndexedMesh fans(Random& random) {
  IndexedMesh mesh = open_book(1 + random.below(7));
  append(mesh, wheel(3 + random.below(12)), Vec3(0.0, 0.0, -0.3));  // a bow tie at the origin
  append(mesh, moebius_strip(3 + random.below(30)), random.in_cube());
  return mesh;
}

IndexedMesh few_triangles(Random& random) {
  IndexedMesh mesh;
  for (int i = 0; i < 4; ++i) mesh.positions.push_back(random.in_cube());
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}, {0, 2, 3}, {0, 3, 1}};
  mesh.triangles.resize(1 + random.below(4));
  return mesh;
}

IndexedMesh high_valence(Random& random) {
  return with_normal_noise(wheel(random.chance(0.2) ? 5000 : 3 + random.below(200)), 0.1,
                           random.below(1000));
}

IndexedMesh tame(Random& random) {
  const std::uint64_t seed = random.below(1000);
  const std::array<std::function<IndexedMesh()>, 6> shapes = {
      [&] { return sphere(2, 1.0); },   [&] { return torus(20, 10, 1.0, 0.4); },
      [&] { return pierced_block(3); }, [&] { return saddle(12, 0.2, seed); },
      [&] { return ring(20, 1); },      [&] { return irregular_sphere(2, 1.0, 0.3, seed); }};
  return with_normal_noise(shapes[random.below(shapes.size())](), random.uniform(0.0, 1.0), seed);
}

struct Kind {
  const char* name;
  IndexedMesh (*make)(Random&);
};
constexpr std::array<Kind, 10> kKinds = {{{"soup", soup},
                                          {"needles", needles},
                                          {"slivers", slivers},
                                          {"lattice", lattice},
                                          {"wild coordinates", wild_coordinates},
                                          {"crowd", crowd},
                                          {"fans", fans},
                                          {"few triangles", few_triangles},
                                          {"high valence", high_valence},
                                          {"tame", tame}}};

/// Flips, repeats and degenerates triangles, each kind with a small probability per triangle.
void spoil_triangles(IndexedMesh& mesh, Random& random) {
  const bool flip = random.chance(0.2);
  const bool repeat = random.chance(0.2);
  const bool degenerate = random.chance(0.2);
  for (std::size_t f = 0, n = mesh.triangles.size(); f < n; ++f) {
    Triangle& t = mesh.triangles[f];
    if (flip && random.chance(0.1)) std::swap(t[0], t[1]);
    const Triangle copy = t;
    if (degenerate && random.chance(0.05)) t[0] = t[1];
    if (repeat && random.chance(0.1)) mesh.triangles.push_back(copy);
  }
}

/// Tears vertices into copies, adds isolated ones, moves some onto others.
void spoil_vertices(IndexedMesh& mesh, Random& random) {
  if (random.chance(0.2)) {
    for (Triangle& t : mesh.triangles) {
      for (Index& v : t) {
        if (!random.chance(0.3)) continue;
        mesh.positions.emplace_back(mesh.positions[v]);
        v = static_cast<Index>(mesh.positions.size()) - 1;
      }
    }
  }
  if (random.chance(0.3)) {
    for (int i = 0; i < 5; ++i) mesh.positions.push_back(random.in_cube() * 3.0);
    mesh.positions.emplace_back(-0.0, 1.0, -0.0);
  }
  if (random.chance(0.1)) {
    mesh.positions[random.below(mesh.positions.size())] =
        mesh.positions[random.below(mesh.positions.size())];
  }
}

}  // namespace

RandomMesh random_mesh(std::uint64_t seed) {
  Random random(seed);
  const Kind& kind = kKinds[random.below(kKinds.size())];
  RandomMesh out{kind.name, kind.make(random)};
  spoil_triangles(out.mesh, random);
  spoil_vertices(out.mesh, random);
  if (random.chance(0.2)) {
    const double scale = std::pow(10.0, random.uniform(-12.0, 12.0));
    const Vec3 offset = random.chance(0.5) ? random.in_cube() * 1e6 * scale : Vec3::Zero().eval();
    for (Vec3& p : out.mesh.positions) p = scale * p + offset;
  }
  return out;
}

FlowOptions random_options(std::uint64_t seed) {
  Random random(seed ^ 0x5DEECE66DU);
  constexpr std::array<double, 6> kTimeSteps = {1e-9, 0.01, 0.1, 0.3, 2.0, 1000.0};
  FlowOptions options;
  options.method = static_cast<Method>(random.chance(0.1) ? random.below(5) : 1 + random.below(4));
  options.integration = static_cast<Integration>(random.chance(0.3));
  if (random.chance(0.5)) options.mass = static_cast<Mass>(random.below(2));
  options.measure = static_cast<CurvatureMeasure>(random.below(3));
  if (random.chance(0.8)) options.steps = 1 + random.below(4);
  if (random.chance(0.7)) options.step_size = kTimeSteps[random.below(kTimeSteps.size())];
  if (random.chance(0.3)) {
    options.feature_angle = random.uniform(0.01, 180.0);
  } else if (random.chance(0.3)) {
    options.lambda = std::pow(10.0, random.uniform(-18.0, 18.0));
  }
  if (random.chance(0.2)) options.transition = random.chance(0.5) ? 0.0 : 1e9;
  options.curvature_smoothing.passes = static_cast<int>(random.below(4));
  if (random.chance(0.5)) options.curvature_smoothing.fraction = random.uniform();
  options.boundary = static_cast<Boundary>(random.below(2));
  options.conventions = static_cast<Conventions>(random.below(2));
  options.guards.unfold = random.chance(0.7);
  options.guards.min_component = random.chance(0.7) ? 12 : static_cast<int>(random.below(4));
  options.guards.local_step = random.chance(0.8);
  return options;
}

std::string describe(const FlowOptions& o) {
  return fmt::format(
      "method {} {} mass {} measure {} steps {} step_size {} angle {} lambda {} transition {} "
      "smoothing {}x{} boundary {} conventions {} unfold {} min_component {} local_step {}",
      static_cast<int>(o.method),
      o.integration == Integration::semi_implicit ? "semi-implicit" : "explicit",
      o.mass ? static_cast<int>(*o.mass) : -1, static_cast<int>(o.measure), o.steps.value_or(-1),
      o.step_size.value_or(-1.0), o.feature_angle.value_or(-1.0), o.lambda.value_or(-1.0),
      o.transition, o.curvature_smoothing.passes, o.curvature_smoothing.fraction,
      static_cast<int>(o.boundary), static_cast<int>(o.conventions), o.guards.unfold,
      o.guards.min_component, o.guards.local_step);
}

}  // namespace fairway::test
