// The path of minimisations, its weights, targets and end. Symbols as in core/EQUATIONS.md.

#include "core/variational.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include "core/edge_geometry.h"
#include "core/median.h"
#include "core/surface_geometry.h"

namespace fairway {
namespace {

/// Three coordinates and the probe.
using Vec4 = Eigen::Vector4d;
/// Symmetric: xx, yy, zz, xy, xz, yz.
using Sym = Eigen::Matrix<double, 6, 1>;

constexpr int kMostIterates = kMostVariationalSteps;
constexpr int kEarliestLeast = 5;  // the least GCV is looked for from this iterate on
constexpr int kPatience = 6;
constexpr int kFirstPower = -5;  // μ of the first iterate is 2 to this
constexpr int kSolverIterations = 60;
constexpr double kSolverTolerance = 1e-4;
constexpr double kGaussian = 0.6745;  // median of |g| of the standard normal
constexpr double kBendDeviations = 3.25;
constexpr double kTransition = 10.0;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kShrinkagePasses = 20;
constexpr double kShrinkageCap = 300.0;
constexpr double kShrinkage = 3.0;

/// The same numbers on every machine (splitmix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }
  double sign() { return (bits() & 1U) != 0 ? 1.0 : -1.0; }
  double unit() { return (static_cast<double>(bits() >> 11U) + 0.5) * 0x1p-53; }
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(unit()));
    return radius * std::cos(2.0 * std::numbers::pi * unit());
  }

 private:
  std::uint64_t state_;
};

Sym outer(const Vec3& t, double scale) {
  Sym s;
  s << t.x() * t.x(), t.y() * t.y(), t.z() * t.z(), t.x() * t.y(), t.x() * t.z(), t.y() * t.z();
  return s * scale;
}

double quadratic(const Sym& s, const Vec3& y) {
  return s[0] * y.x() * y.x() + s[1] * y.y() * y.y() + s[2] * y.z() * y.z() +
         2.0 * (s[3] * y.x() * y.y() + s[4] * y.x() * y.z() + s[5] * y.y() * y.z());
}

double squared_norm(const Sym& s) {
  return s.head<3>().squaredNorm() + 2.0 * s.tail<3>().squaredNorm();
}

/// An interior edge between two faces that are there.
struct InnerEdge {
  std::array<Index, 4> points;  ///< p, q, o0, o1
  std::array<Index, 2> faces;
};

/// Of an edge in one iterate.
struct EdgeState {
  std::array<double, 4> c{};  ///< coefficients of D_e
  Vec3 normal = Vec3::Zero();
  double height = 0.0;         ///< h_e
  double weight = 0.0;         ///< w_e
  Vec4 target = Vec4::Zero();  ///< δ_e N_e, and the probe's δ_e
};

class Path {
 public:
  Path(const TriangleMesh& mesh, std::span<const unsigned char> held);
  bool has_nothing() const { return edges_.empty() || sigma_ <= 0.0; }
  VariationalStep iterate(int number);
  bool take_if_best(const VariationalStep& step);
  VariationalResult take() &&;
  bool is_over(int number) const { return number > std::max(least_, kEarliestLeast) + kPatience; }
  bool is_finite() const;

 private:
  void find_edges(const FaceGeometry& faces);
  void find_noise();
  void measure(const FaceGeometry& faces);
  double weigh(const FaceGeometry& faces);
  void prescribe(const FaceGeometry& faces, double mu);
  void shrink(const std::vector<double>& q, double qz);
  int solve(double mu);
  void apply(const std::vector<Vec4>& x, std::vector<Vec4>& out, double mu, double alpha) const;
  std::vector<double> normal_displacement() const;
  template <class Field>
  void diffuse(std::vector<Field>& field, int passes) const;
  std::vector<double> umbrella_fourth(const std::vector<Vec3>& field) const;

  const TriangleMesh& mesh_;
  const std::span<const unsigned char> held_;
  const std::size_t n_;
  std::vector<InnerEdge> edges_;
  std::vector<std::array<Index, 3>> face_edges_;  ///< kNoIndex where there is none
  std::vector<Vec3> normals_;                     ///< of the start, averaged once
  double sigma_ = 0.0;
  double mean_edge_ = 0.0;
  std::vector<Vec4> start_;
  std::vector<Vec4> x_;
  std::vector<EdgeState> state_;
  std::vector<double> bend_target_;  ///< τ_e
  std::vector<double> data_;         ///< c_v
  std::vector<Vec3> best_;
  double best_gcv_ = 0.0;
  int least_ = 0;
};

std::vector<Vec3> positions_of(const std::vector<Vec4>& x) {
  std::vector<Vec3> out(x.size());
  for (std::size_t v = 0; v < x.size(); ++v) out[v] = x[v].head<3>();
  return out;
}

Path::Path(const TriangleMesh& mesh, std::span<const unsigned char> held)
    : mesh_(mesh),
      held_(held),
      n_(mesh.vertex_count()),
      mean_edge_(mesh.mean_edge_length()),
      data_(n_, 1.0) {
  const FaceGeometry faces =
      face_geometry(mesh, mesh.positions(), smallest_area(mesh.mean_edge_length()));
  find_edges(faces);
  const std::vector<Vec3> once = vertex_normals(mesh, faces);
  normals_ = once;
  for (std::size_t v = 0; v < n_; ++v) {
    for (const Index w : mesh.rings()[v]) normals_[v] += once[w];
    normals_[v].normalize();
    if (!normals_[v].allFinite()) normals_[v].setZero();
  }
  find_noise();
  Random random(20040901);
  start_.resize(n_);
  for (std::size_t v = 0; v < n_; ++v) start_[v] << mesh.positions()[v], random.sign();
  x_ = start_;
  state_.resize(edges_.size());
  bend_target_.assign(edges_.size(), 0.0);
}

void Path::find_edges(const FaceGeometry& faces) {
  face_edges_.assign(mesh_.faces().size(), {kNoIndex, kNoIndex, kNoIndex});
  for (const Edge& edge : mesh_.edges()) {
    if (!edge.interior() || !faces.present(edge.face0) || !faces.present(edge.face1)) continue;
    const auto number = static_cast<Index>(edges_.size());
    edges_.push_back({{edge.p, edge.q, edge.opposite0, edge.opposite1}, {edge.face0, edge.face1}});
    for (const Index face : edges_.back().faces) {
      *std::find(face_edges_[face].begin(), face_edges_[face].end(), kNoIndex) = number;
    }
  }
}

/// |((I − W)⁴ field)·N| at interior vertices.
std::vector<double> Path::umbrella_fourth(const std::vector<Vec3>& field) const {
  std::vector<Vec3> now = field;
  std::vector<Vec3> next(n_);
  for (int pass = 0; pass < 4; ++pass) {
    for (std::size_t v = 0; v < n_; ++v) {
      Vec3 mean = Vec3::Zero();
      for (const Index w : mesh_.rings()[v]) mean += now[w];
      next[v] =
          now[v] - mean / static_cast<double>(std::max<std::size_t>(mesh_.rings()[v].size(), 1));
    }
    now.swap(next);
  }
  std::vector<double> values;
  values.reserve(n_);
  for (std::size_t v = 0; v < n_; ++v) {
    if (!mesh_.boundary_vertex()[v]) values.push_back(std::abs(now[v].dot(normals_[v])));
  }
  return values;
}

/// σ: how much of what four differences leave is noise, by comparison with noise of size 1.
void Path::find_noise() {
  Random random(1);
  std::vector<Vec3> noise(n_);
  for (std::size_t v = 0; v < n_; ++v) noise[v] = random.normal() * normals_[v];
  auto seen = umbrella_fourth(mesh_.positions());
  auto known = umbrella_fourth(noise);
  const double unit = median(known);
  sigma_ = unit > 0.0 ? median(seen) / unit : 0.0;
}

std::vector<double> Path::normal_displacement() const {
  std::vector<double> d(n_);
  for (std::size_t v = 0; v < n_; ++v) {
    d[v] = (x_[v] - start_[v]).head<3>().dot(normals_[v]);
  }
  return d;
}

/// a. The operator D_e at the surface of now.
void Path::measure(const FaceGeometry& faces) {
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const auto [p, q, o0, o1] = edges_[e].points;
    const auto [f0, f1] = edges_[e].faces;
    EdgeState& state = state_[e];
    const double a0 = faces.areas[f0];
    const double a1 = faces.areas[f1];
    const Vec3 along = (x_[q] - x_[p]).head<3>();
    const double l2 = along.squaredNorm();
    const double sum = a0 + a1;
    if (!(sum > 0.0) || !(l2 > 0.0)) {
      state = {};
      continue;
    }
    const double t0 = (x_[o0] - x_[p]).head<3>().dot(along) / l2;
    const double t1 = (x_[o1] - x_[p]).head<3>().dot(along) / l2;
    const double t = (a1 * t0 + a0 * t1) / sum;
    state.c = {t - 1.0, -t, a1 / sum, a0 / sum};
    state.height = 2.0 * a0 * a1 / (sum * std::sqrt(l2));
    state.normal = (faces.normals[f0] + faces.normals[f1]).normalized();
    if (!state.normal.allFinite()) state.normal.setZero();
  }
}

/// D_e of a field.
Vec4 sag(const InnerEdge& edge, const EdgeState& state, const std::vector<Vec4>& x) {
  return state.c[0] * x[edge.points[0]] + state.c[1] * x[edge.points[1]] +
         state.c[2] * x[edge.points[2]] + state.c[3] * x[edge.points[3]];
}

/// b. Weights on what the target does not explain. Returns λ at the median height.
double Path::weigh(const FaceGeometry& faces) {
  std::vector<double> residual(edges_.size());
  std::vector<double> heights;
  heights.reserve(edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Vec3& n0 = faces.normals[edges_[e].faces[0]];
    const Vec3& n1 = faces.normals[edges_[e].faces[1]];
    const double half = std::min((n0 - n1).norm() / 2.0, 1.0);
    const Vec3 s = sag(edges_[e], state_[e], x_).head<3>();
    const double bend = std::copysign(2.0 * std::asin(half), s.dot(n0 + n1));
    residual[e] = std::abs(bend - bend_target_[e]);
    heights.push_back(state_[e].height);
  }
  std::vector<double> ordered = residual;
  const double b = median(ordered) / kGaussian;
  const double middle = median(heights);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const double ratio = state_[e].height > 0.0 ? middle / state_[e].height : 16.0;
    const double s = std::clamp(ratio, 0.25, 16.0);
    const double lambda = std::clamp(kBendDeviations * b * s, 1.0 * kDegree,
                                     90.0 * kDegree * std::clamp(s, 1.0, 2.0));
    state_[e].weight = edge_weight(residual[e], lambda, kTransition);
  }
  return kBendDeviations * b;
}

/// F_f ← (F_f + Σ w_e F_g) / 4 over the three neighbours, `passes` times: features are barriers.
template <class Field>
void Path::diffuse(std::vector<Field>& field, int passes) const {
  std::vector<Field> next(field.size());
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t f = 0; f < field.size(); ++f) {
      Field sum = field[f];
      for (const Index e : face_edges_[f]) {
        if (e == kNoIndex) continue;
        const auto [f0, f1] = edges_[e].faces;
        sum += state_[e].weight * field[f0 == f ? f1 : f0];
      }
      next[f] = sum * 0.25;
    }
    field.swap(next);
  }
}

/// Of the surface, of the probe, and the areas that both are shares of.
struct FaceShape {
  Sym surface = Sym::Zero();
  Sym probe = Sym::Zero();
  double area = 0.0;

  FaceShape& operator+=(const FaceShape& other) {
    surface += other.surface;
    probe += other.probe;
    area += other.area;
    return *this;
  }
  friend FaceShape operator*(double s, const FaceShape& a) {
    return {a.surface * s, a.probe * s, a.area * s};
  }
  FaceShape operator*(double s) const { return s * *this; }
};

/// A value and how much of it there is.
struct Share {
  double value = 0.0;
  double weight = 0.0;

  Share& operator+=(const Share& other) {
    value += other.value;
    weight += other.weight;
    return *this;
  }
  friend Share operator*(double s, const Share& a) { return {a.value * s, a.weight * s}; }
  Share operator*(double s) const { return s * *this; }
};

/// c. Targets from the smoothed shape operator.
void Path::prescribe(const FaceGeometry& faces, double mu) {
  std::vector<FaceShape> shape(mesh_.faces().size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const InnerEdge& edge = edges_[e];
    const EdgeState& state = state_[e];
    const Vec3 along = (x_[edge.points[1]] - x_[edge.points[0]]).head<3>();
    const double l = along.norm();
    const Vec3 across = along.cross(state.normal).normalized();
    if (!across.allFinite()) continue;
    const Vec4 s = sag(edge, state, x_);
    const double scale = state.weight * l / std::max(state.height, 0.05 * l);
    const double area = faces.areas[edge.faces[0]] + faces.areas[edge.faces[1]];
    const FaceShape part{outer(across, scale * s.head<3>().dot(state.normal)),
                         outer(across, scale * s[3]), state.weight * area / 3.0};
    for (const Index face : edge.faces) shape[face] += part;
  }
  diffuse(shape, static_cast<int>(std::clamp(std::round(5.0 * std::pow(mu, 0.3)), 2.0, 60.0)));
  std::vector<double> q(edges_.size());
  double qz = 0.0;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const InnerEdge& edge = edges_[e];
    EdgeState& state = state_[e];
    FaceShape both = shape[edge.faces[0]];
    both += shape[edge.faces[1]];
    state.target.setZero();
    if (!(both.area > 0.0)) continue;
    const Sym surface = both.surface / both.area;
    const Sym probe = both.probe / both.area;
    const Vec3 middle = (x_[edge.points[0]] + x_[edge.points[1]]).head<3>() / 2.0;
    double of_surface = 0.0;
    double of_probe = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 y = x_[edge.points[k]].head<3>() - middle;
      of_surface += state.c[k] * quadratic(surface, y);
      of_probe += state.c[k] * quadratic(probe, y);
    }
    state.target << state.normal * (0.5 * of_surface), 0.5 * of_probe;
    const double h4 = std::pow(state.height, 4);
    q[e] = h4 * squared_norm(surface);
    qz += h4 * squared_norm(probe);
  }
  shrink(q, sigma_ * sigma_ * qz / static_cast<double>(edges_.size()));
}

/// η_e: curvature that noise alone would show as often is none.
void Path::shrink(const std::vector<double>& q, double qz) {
  std::vector<Share> field(mesh_.faces().size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Share part{std::min(q[e], kShrinkageCap * qz), 1.0};
    for (const Index face : edges_[e].faces) field[face] += part;
  }
  diffuse(field, kShrinkagePasses);
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const InnerEdge& edge = edges_[e];
    Share both = field[edge.faces[0]];
    both += field[edge.faces[1]];
    const double mean = both.weight > 0.0 ? both.value / both.weight : 0.0;
    EdgeState& state = state_[e];
    state.target *= mean > 0.0 ? std::max(0.0, 1.0 - kShrinkage * qz / mean) : 0.0;
    const double bend =
        state.height > 0.0 ? state.target.head<3>().dot(state.normal) / state.height : 0.0;
    bend_target_[e] = std::clamp(bend, -1.0, 1.0);
  }
}

/// out = (C + μ DᵀWD + (α/4) EᵀE) x.
void Path::apply(const std::vector<Vec4>& x, std::vector<Vec4>& out, double mu,
                 double alpha) const {
  for (std::size_t v = 0; v < n_; ++v) out[v] = data_[v] * x[v];
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const InnerEdge& edge = edges_[e];
    const EdgeState& state = state_[e];
    const auto [p, q, o0, o1] = edge.points;
    const Vec4 bend = (mu * state.weight) * sag(edge, state, x);
    const Vec4 fair = (0.25 * alpha) * (x[p] + x[q] - x[o0] - x[o1]);
    out[p] += state.c[0] * bend + fair;
    out[q] += state.c[1] * bend + fair;
    out[o0] += state.c[2] * bend - fair;
    out[o1] += state.c[3] * bend - fair;
  }
  for (std::size_t v = 0; v < n_; ++v) {
    if (held_[v]) out[v].head<3>().setZero();
  }
}

/// d. Preconditioned conjugate gradients for four right-hand sides, each with its own numbers.
int Path::solve(double mu) {
  const double relative = sigma_ / mean_edge_;
  const double alpha = std::min(2.0, 10.0 * relative * relative) * std::min(1.0, 0.5 / mu);
  std::vector<Vec4> r(n_);
  std::vector<double> diagonal = data_;
  for (std::size_t v = 0; v < n_; ++v) r[v] = data_[v] * start_[v];
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const EdgeState& state = state_[e];
    for (std::size_t k = 0; k < 4; ++k) {
      const Index v = edges_[e].points[k];
      r[v] += (mu * state.weight * state.c[k]) * state.target;
      diagonal[v] += mu * state.weight * state.c[k] * state.c[k] + 0.25 * alpha;
    }
  }
  std::vector<Vec4> a(n_);
  apply(x_, a, mu, alpha);
  Vec4 rho = Vec4::Zero();
  std::vector<Vec4> direction(n_);
  for (std::size_t v = 0; v < n_; ++v) {
    r[v] -= a[v];
    if (held_[v]) r[v].head<3>().setZero();
    direction[v] = r[v] / diagonal[v];
    rho += r[v].cwiseProduct(direction[v]);
  }
  const double n = static_cast<double>(n_);
  const double small = kSolverTolerance * n;
  int iteration = 0;
  const auto enough = [&] {
    return rho.head<3>().sum() <= small * sigma_ * sigma_ && rho[3] <= small;
  };
  for (; iteration < kSolverIterations && !enough(); ++iteration) {
    apply(direction, a, mu, alpha);
    Vec4 curvature = Vec4::Zero();
    for (std::size_t v = 0; v < n_; ++v) curvature += direction[v].cwiseProduct(a[v]);
    Vec4 length = Vec4::Zero();
    for (int k = 0; k < 4; ++k) length[k] = curvature[k] > 0.0 ? rho[k] / curvature[k] : 0.0;
    Vec4 next = Vec4::Zero();
    for (std::size_t v = 0; v < n_; ++v) {
      x_[v] += length.cwiseProduct(direction[v]);
      r[v] -= length.cwiseProduct(a[v]);
      next += r[v].cwiseAbs2() / diagonal[v];
    }
    Vec4 beta = Vec4::Zero();
    for (int k = 0; k < 4; ++k) beta[k] = rho[k] > 0.0 ? next[k] / rho[k] : 0.0;
    for (std::size_t v = 0; v < n_; ++v) {
      direction[v] = r[v] / diagonal[v] + beta.cwiseProduct(direction[v]);
    }
    rho = next;
  }
  return iteration;
}

VariationalStep Path::iterate(int number) {
  VariationalStep step;
  step.step = number;
  step.mu = std::ldexp(1.0, number - 1 + kFirstPower);
  const FaceGeometry faces = face_geometry(mesh_, positions_of(x_), smallest_area(mean_edge_));
  measure(faces);
  step.lambda = weigh(faces);
  prescribe(faces, step.mu);
  step.solver_iterations = solve(step.mu);
  // e. How much freedom is left, and how far the surface went.
  double f = 0.0;
  double rho = 0.0;
  const std::vector<double> d = normal_displacement();
  for (std::size_t v = 0; v < n_; ++v) {
    f += start_[v][3] * x_[v][3];
    rho += d[v] * d[v];
    const double far = d[v] / (3.0 * sigma_);
    data_[v] = 1.0 / (1.0 + far * far);
  }
  f /= static_cast<double>(n_);
  rho /= static_cast<double>(n_);
  const double penalty = f + 0.25 * f * (1.0 - f) + 0.5 * std::min(f, 0.05) * (1.0 - f);
  step.degrees_of_freedom = f;
  step.gcv = rho / ((1.0 - penalty) * (1.0 - penalty));
  return step;
}

bool Path::take_if_best(const VariationalStep& step) {
  const bool counts = step.step > kEarliestLeast;
  if (best_.empty() || step.gcv < best_gcv_) {
    best_gcv_ = step.gcv;
    best_ = positions_of(x_);
    if (counts) least_ = step.step - 1;
    return true;
  }
  return false;
}

bool Path::is_finite() const {
  return std::all_of(x_.begin(), x_.end(), [](const Vec4& x) { return x.allFinite(); });
}

VariationalResult Path::take() && {
  VariationalResult result;
  if (best_.empty()) best_ = mesh_.positions();
  result.positions = std::move(best_);
  for (std::size_t v = 0; v < n_; ++v) {
    if (held_[v]) result.positions[v] = mesh_.positions()[v];
  }
  result.report.noise = sigma_;
  return result;
}

}  // namespace

Result<VariationalResult> denoise_variational(
    const TriangleMesh& mesh, std::span<const unsigned char> held,
    const VariationalOptions& options, const std::function<void(const VariationalStep&)>& observer,
    std::stop_token stop) {
  Path path(mesh, held);
  const int most = options.strength ? static_cast<int>(std::ceil(*options.strength * kMostIterates))
                                    : kMostIterates;
  std::vector<VariationalStep> steps;
  int chosen = 0;
  for (int number = 1; number <= most && !path.has_nothing(); ++number) {
    if (stop.stop_requested()) {
      return Error{ErrorCode::canceled, "The run was canceled between two iterates."};
    }
    steps.push_back(path.iterate(number));
    if (!path.is_finite()) {
      return Error{ErrorCode::diverged,
                   "The variational method diverged at iterate " + std::to_string(number) + "."};
    }
    if (path.take_if_best(steps.back())) chosen = number;
    steps.back().gcv /= mesh.mean_edge_length() * mesh.mean_edge_length();
    if (observer) observer(steps.back());
    if (path.is_over(number)) break;
  }
  VariationalResult result = std::move(path).take();
  result.report.chosen = chosen;
  result.report.strength = static_cast<double>(chosen) / kMostIterates;
  result.report.path = std::move(steps);
  return result;
}

VariationalReport find_variational_noise(const TriangleMesh& mesh, unsigned /*threads*/) {
  const std::vector<unsigned char> held(mesh.vertex_count());
  VariationalReport report = Path(mesh, held).take().report;
  if (!(report.noise > 0.0)) report.kind = FoundNoise::none;
  return report;
}

}  // namespace fairway
