// The explicit flows on packed kernels: what is dense runs in the kernels, what is sparse (groups
// of strong edges, feature vertices) here. Source: Hildebrandt & Polthier 2004, eqs. (6)–(11).

#include "core/packed_flow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/edge_geometry.h"
#include "core/implicit_system.h"
#include "core/median.h"
#include "core/packed_mesh.h"
#include "core/strong_groups.h"
#include "core/thread_team.h"

namespace fairway {
namespace {

constexpr std::size_t kGrain = 256;  // slices per range
constexpr std::size_t kSampledSlices = 2048;
constexpr std::size_t kDoubleVertices = 20'000;
// |N0 − N1|² of an edge bent by 120°.
constexpr double kFolded = 3.0;
// |H_A^s| below this many mean edges has no direction.
constexpr double kNoDirection = 1e-14;
constexpr double kMedianOfNormal = 0.6745;
constexpr double kSolverTolerance = 1e-12;
constexpr int kSolverIterations = 1000;
constexpr int kMostHalvings = 6;

template <class Real>
using Stored = Quad<typename StoredCoordinate<Real>::Type>;

template <class Real>
struct Vector {
  Real x, y, z;
  friend Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend Vector operator*(const Vector& a, Real s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Real dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  friend Real length(const Vector& a) { return std::sqrt(dot(a, a)); }
};

template <class Real>
Vector<Real> vector_of(const Quad<Real>& q) {
  return {q.x, q.y, q.z};
}

/// Fixed point in single precision: one unit, in L, for coordinates up to `largest`.
double quantum_for(double largest) {
  // Twice the room that is needed now; a step that needs more makes units larger.
  return std::exp2(std::ceil(std::log2(std::max(largest, 1.0))) + 1.0 - 31.0);
}
constexpr double kLargestStored = 2.1e9;

template <class Real>
class Flow final : public PackedFlow {
 public:
  Flow(const TriangleMesh& mesh, std::span<const Vec3> positions, double mean_edge,
       std::span<const unsigned char> held, const FlowOptions& options, const Execution& execution);

  Bends bends(bool sampled) override;
  double roughness() override;
  void mark_start() override;
  Outcome step(double lambda, double time_step, double bound) override;
  std::vector<unsigned char> features() const override;
  double displacement() override;
  std::size_t kernel_bytes() const override;
  std::vector<Vec3> positions(std::span<const Vec3> start) const override;

 private:
  KernelMesh<Real> kernel_mesh() const {
    return {packed_.slices().data(), packed_.ring().data(), x_.data(), static_cast<Real>(quantum_)};
  }
  KernelFields<Real> fields() {
    return {curvature_.data(), direction_.data(), value_.data(), strong_.data()};
  }
  void compute_curvature(const StepNumbers<Real>& numbers);
  void weaken(const StrongEdge& edge, const StepNumbers<Real>& numbers);
  void prescribe_at_feature(Index slot);
  void apply_features(const StepNumbers<Real>& numbers);
  void smooth_values(MoveNumbers<Real>& numbers);
  Real curvature_value(Index slot) const;
  Vector<Real> smoothed_curvature(Index slot) const;
  bool move(const MoveNumbers<Real>& numbers, double bound);
  bool needs_system() const;
  void average_values(const MoveNumbers<Real>& numbers);
  Outcome solve_step(const StepNumbers<Real>& numbers, double bound);
  Outcome move_by_solution(std::span<const Quad<double>> velocity, const StepNumbers<Real>& numbers,
                           double bound);
  void coarsen();
  Vector<Real> between(Index from, Index to) const;
  bool is_feature(Index slot) const { return (bits(value_[slot]) & 1U) != 0; }

  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  static Bits bits(Real value) { return std::bit_cast<Bits>(value); }
  static Real tagged(Real value, bool feature) {
    return std::bit_cast<Real>((bits(value) & ~Bits{1}) | Bits{feature});
  }

  PackedMesh packed_;
  const FlowOptions options_;
  const FlowKernels<Real>& kernels_;
  ThreadTeam team_;
  double mean_edge_;
  double quantum_ = 1.0;
  std::vector<Stored<Real>> x_, next_, start_;
  std::vector<Quad<Real>> curvature_, direction_, normals_;
  std::vector<Real> value_, other_value_;
  std::vector<std::uint8_t> strong_;
  std::vector<Index> held_;  // slots
  StrongGroups groups_;
  std::optional<ImplicitSystem> system_;
};

template <class Real>
Flow<Real>::Flow(const TriangleMesh& mesh, std::span<const Vec3> positions, double mean_edge,
                 std::span<const unsigned char> held, const FlowOptions& options,
                 const Execution& execution)
    : packed_(mesh),
      options_(options),
      kernels_(flow_kernels<Real>(execution.isa)),
      team_(execution.threads),
      mean_edge_(mean_edge) {
  if constexpr (std::is_same_v<Real, float>) {
    double largest = 0.0;
    for (const Vec3& p : positions) largest = std::max(largest, p.cwiseAbs().maxCoeff());
    quantum_ = quantum_for(largest / mean_edge);
  }
  const std::size_t slots = packed_.slot_count();
  x_.resize(slots, {});
  next_.resize(slots);
  curvature_.resize(slots);
  direction_.resize(slots);
  value_.resize(slots);
  strong_.resize(packed_.column_count());
  const double scale = 1.0 / (mean_edge * quantum_);
  for (std::size_t slot = 0; slot < slots; ++slot) {
    const Index v = packed_.vertex_of_slot()[slot];
    if (v == kNoIndex) continue;
    const Vec3 p = positions[v] * scale;
    if constexpr (std::is_same_v<Real, float>) {
      x_[slot] = {static_cast<std::int32_t>(std::lround(p.x())),
                  static_cast<std::int32_t>(std::lround(p.y())),
                  static_cast<std::int32_t>(std::lround(p.z())), 0};
    } else {
      x_[slot] = {p.x(), p.y(), p.z(), 0.0};
    }
    if (held[v] != 0) held_.push_back(static_cast<Index>(slot));
  }
}

template <class Real>
Vector<Real> Flow<Real>::between(Index from, Index to) const {
  const Stored<Real>& p = x_[from];
  const Stored<Real>& q = x_[to];
  const auto unit = static_cast<Real>(quantum_);
  return {static_cast<Real>(q.x - p.x) * unit, static_cast<Real>(q.y - p.y) * unit,
          static_cast<Real>(q.z - p.z) * unit};
}

template <class Real>
PackedFlow::Bends Flow<Real>::bends(bool sampled) {
  const std::size_t slices = packed_.slices().size();
  const std::size_t stride = sampled ? std::max<std::size_t>(1, slices / kSampledSlices) : 1;
  std::vector<Real> values;
  const KernelMesh<Real> mesh = kernel_mesh();
  for (std::size_t s = 0; s < slices; s += stride) {
    const std::size_t before = values.size();
    values.resize(before + kLanes * std::size_t{packed_.slices()[s].valence});
    kernels_.bends(mesh, static_cast<Index>(s), static_cast<Index>(s + 1), values.data() + before);
  }
  std::erase_if(values, [](Real squared) { return squared < 0; });
  if (values.empty()) return {};
  const bool folded = *std::max_element(values.begin(), values.end()) > static_cast<Real>(kFolded);
  const double squared = static_cast<double>(median_of_positive(values));
  return {2.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(squared))) / kMedianOfNormal, folded};
}

template <class Real>
void Flow<Real>::compute_curvature(const StepNumbers<Real>& numbers) {
  const KernelMesh<Real> mesh = kernel_mesh();
  const KernelFields<Real> out = fields();
  team_.for_ranges(packed_.slices().size(), kGrain, [&](std::size_t first, std::size_t last) {
    kernels_.curvature(mesh, numbers, out, static_cast<Index>(first), static_cast<Index>(last));
  });
  for (const Index slot : held_) curvature_[slot].w = 0;
}

template <class Real>
double Flow<Real>::roughness() {
  constexpr Real kNever = std::numeric_limits<Real>::infinity();
  compute_curvature(
      {.time_step = 1, .lambda = kNever, .transition = 0, .local_step = false, .prescribed = true});
  // h = ⟨N, H⟩ / M, and c = 1 / M for this time step.
  std::vector<Real> h(packed_.slot_count());
  for (std::size_t slot = 0; slot < h.size(); ++slot) {
    const Vector<Real> volume = vector_of(direction_[slot]);
    const Real size = length(volume);
    h[slot] =
        size > 0 ? dot(vector_of(curvature_[slot]), volume) / size * curvature_[slot].w : Real{0};
  }
  std::vector<double> magnitude;
  std::vector<double> deviation;
  for (std::size_t s = 0; s < packed_.slices().size(); ++s) {
    const Slice& slice = packed_.slices()[s];
    if (slice.open) continue;
    for (std::size_t slot = kLanes * s; slot < kLanes * (s + 1); ++slot) {
      if (packed_.vertex_of_slot()[slot] == kNoIndex) continue;
      double sum = 0.0;
      for (Index k = 0; k < slice.valence; ++k) {
        sum += static_cast<double>(
            h[packed_.ring()[kLanes * (std::size_t{slice.columns} + k) + slot % kLanes]]);
      }
      magnitude.push_back(std::abs(static_cast<double>(h[slot])));
      deviation.push_back(std::abs(static_cast<double>(h[slot]) - sum / slice.valence));
    }
  }
  const double scale = median(magnitude);
  return scale > 0.0 ? median(deviation) / scale : 0.0;
}

template <class Real>
void Flow<Real>::mark_start() {
  start_ = x_;
  compute_curvature(
      {.time_step = 1, .lambda = 1, .transition = 1, .local_step = false, .prescribed = true});
  normals_ = direction_;
  for (Quad<Real>& n : normals_) {
    const Real size = length(vector_of(n));
    if (size > 0) n = {n.x / size, n.y / size, n.z / size, 0};
  }
}

template <class Real>
double Flow<Real>::displacement() {
  const KernelMesh<Real> mesh = kernel_mesh();
  const std::size_t slices = packed_.slices().size();
  std::vector<double> parts((slices + kGrain - 1) / kGrain);
  team_.for_ranges(slices, kGrain, [&](std::size_t first, std::size_t last) {
    parts[first / kGrain] = kernels_.displacement(
        mesh, start_.data(), normals_.data(), static_cast<Index>(first), static_cast<Index>(last));
  });
  double sum = 0.0;
  for (const double part : parts) sum += part;
  return std::sqrt(sum / static_cast<double>(packed_.slot_of_vertex().size()));
}

/// Takes back what the weight took from an edge of a group too small for a feature.
template <class Real>
void Flow<Real>::weaken(const StrongEdge& edge, const StepNumbers<Real>& numbers) {
  const Slice& slice = packed_.slices()[edge.p / kLanes];
  const Index* column =
      packed_.ring().data() + kLanes * std::size_t{slice.columns} + edge.p % kLanes;
  const auto neighbour = [&](Index k) { return column[kLanes * std::size_t{k % slice.valence}]; };
  const Vector<Real> e = between(edge.p, edge.q);
  const auto normal = [](const Vector<Real>& a, const Vector<Real>& b) {
    const Vector<Real> n = cross(a, b);
    return n * (1 / length(n));
  };
  const Vector<Real> left = normal(e, between(edge.p, neighbour(edge.k + 1)));
  const Vector<Real> right = normal(between(edge.p, neighbour(edge.k + slice.valence - 1)), e);
  const Vector<Real> term = cross(e, left - right);
  const Real excess = length(term) / numbers.lambda - 1;
  const Real missing = 1 - 1 / (numbers.transition * excess * excess + 1);
  for (const Index slot : {edge.p, edge.q}) {
    Quad<Real>& h = curvature_[slot];
    h.x += term.x * missing / 2;
    h.y += term.y * missing / 2;
    h.z += term.z * missing / 2;
  }
}

template <class Real>
Real Flow<Real>::curvature_value(Index slot) const {
  const Vector<Real> h = vector_of(curvature_[slot]);
  const Vector<Real> v = vector_of(direction_[slot]);
  const Real squared = dot(v, v);
  if (squared == 0) return 0;
  if (options_.measure == CurvatureMeasure::project) return dot(h, v) / squared;
  const Real f = length(h) / std::sqrt(squared);
  return dot(h, v) < 0 ? -f : f;
}

/// H_A^s of a feature vertex: over the neighbours that the conventions name, weighted by the angles
/// beside the edges.
template <class Real>
Vector<Real> Flow<Real>::smoothed_curvature(Index slot) const {
  const Slice& slice = packed_.slices()[slot / kLanes];
  const Index* column = packed_.ring().data() + kLanes * std::size_t{slice.columns} + slot % kLanes;
  const bool all = options_.conventions == Conventions::paper;
  Vector<Real> sum{0, 0, 0};
  Real weights = 0;
  const auto add = [&](Index q, Real weight) {
    if (!all && !is_feature(q)) return;
    const Quad<Real>& h = curvature_[q];
    sum = {sum.x + weight * h.x, sum.y + weight * h.y, sum.z + weight * h.z};
    weights += weight;
  };
  const auto angle = [](const Vector<Real>& a, const Vector<Real>& b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
  };
  Index q = column[0];
  Vector<Real> e = between(slot, q);
  const Index faces = slice.open ? slice.valence - 1 : slice.valence;
  for (Index k = 0; k < faces; ++k) {
    const Index next = column[kLanes * std::size_t{(k + 1) % slice.valence}];
    const Vector<Real> b = between(slot, next);
    const Real weight = angle(e, b);
    add(q, weight);
    add(next, weight);
    q = next;
    e = b;
  }
  const Vector<Real> own = vector_of(curvature_[slot]);
  if (weights == 0) return own;
  return {(own.x + sum.x / weights) / 2, (own.y + sum.y / weights) / 2,
          (own.z + sum.z / weights) / 2};
}

template <class Real>
void Flow<Real>::prescribe_at_feature(Index slot) {
  const Vector<Real> smoothed = smoothed_curvature(slot);
  const Real size = length(smoothed);
  if (size >= static_cast<Real>(kNoDirection)) {
    const bool inward = dot(smoothed, vector_of(direction_[slot])) < 0;
    const Vector<Real> unit = smoothed * (1 / (inward ? -size : size));
    direction_[slot] = {unit.x, unit.y, unit.z, 0};
  }
  value_[slot] = tagged(curvature_value(slot), true);
}

template <class Real>
void Flow<Real>::apply_features(const StepNumbers<Real>& numbers) {
  groups_.find(packed_, strong_, options_.guards.min_component);
  for (const StrongEdge& edge : groups_.noise()) weaken(edge, numbers);
  if (!numbers.prescribed) return;
  for (const StrongEdge& edge : groups_.noise()) {
    for (const Index slot : {edge.p, edge.q}) value_[slot] = tagged(curvature_value(slot), false);
  }
  // Flags first: who averages with whom depends on them.
  for (const Index slot : groups_.features()) value_[slot] = tagged(value_[slot], true);
  const std::vector<Index>& features = groups_.features();
  team_.for_ranges(features.size(), 4 * kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) prescribe_at_feature(features[i]);
  });
}

/// One smoothing pass of f.
template <class Real>
void Flow<Real>::average_values(const MoveNumbers<Real>& numbers) {
  other_value_.resize(value_.size());
  team_.for_ranges(packed_.slices().size(), kGrain, [&](std::size_t first, std::size_t last) {
    kernels_.average(kernel_mesh(), numbers, value_.data(), static_cast<Index>(first),
                     static_cast<Index>(last), other_value_.data());
  });
  value_.swap(other_value_);
}

/// All smoothing passes but the last, which move() does on the way.
template <class Real>
void Flow<Real>::smooth_values(MoveNumbers<Real>& numbers) {
  const CurvatureSmoothing& smoothing = options_.curvature_smoothing;
  numbers.fraction = smoothing.passes > 0 ? static_cast<Real>(smoothing.fraction) : Real{0};
  for (int pass = 1; pass < smoothing.passes; ++pass) average_values(numbers);
}

/// Doubles the room of fixed-point coordinates twice.
template <class Real>
void Flow<Real>::coarsen() {
  if constexpr (std::is_same_v<Real, float>) {
    quantum_ *= 4.0;
    for (std::vector<Stored<float>>* all : {&x_, &start_}) {
      for (Stored<float>& p : *all) p = {(p.x + 2) >> 2, (p.y + 2) >> 2, (p.z + 2) >> 2, 0};
    }
  }
}

template <class Real>
bool Flow<Real>::move(const MoveNumbers<Real>& numbers, double bound) {
  const std::size_t slices = packed_.slices().size();
  std::vector<Real> parts((slices + kGrain - 1) / kGrain);
  for (;;) {
    team_.for_ranges(slices, kGrain, [&](std::size_t first, std::size_t last) {
      parts[first / kGrain] =
          kernels_.move(kernel_mesh(), numbers, fields(), static_cast<Index>(first),
                        static_cast<Index>(last), next_.data());
    });
    double largest = 0.0;
    for (const Real part : parts) {
      if (!(static_cast<double>(part) * quantum_ <= bound)) return false;
      largest = std::max(largest, static_cast<double>(part));
    }
    if (std::is_same_v<Real, double> || largest <= kLargestStored) break;
    coarsen();
  }
  x_.swap(next_);
  return true;
}

/// Everything but a lumped explicit step solves a linear system.
template <class Real>
bool Flow<Real>::needs_system() const {
  return options_.integration == Integration::semi_implicit || options_.mass == Mass::full;
}

template <class Real>
PackedFlow::Outcome Flow<Real>::step(double lambda, double time_step, double bound) {
  const bool anisotropic = is_anisotropic(options_.method);
  const StepNumbers<Real> numbers = {
      .time_step = static_cast<Real>(time_step),
      .lambda = anisotropic ? static_cast<Real>(lambda) : std::numeric_limits<Real>::infinity(),
      .transition = static_cast<Real>(options_.transition),
      .local_step = options_.guards.local_step,
      .prescribed = is_prescribed(options_.method),
      .measure = static_cast<KernelMeasure>(options_.measure)};
  compute_curvature(numbers);
  if (anisotropic && (numbers.prescribed || options_.guards.min_component > 2)) {
    apply_features(numbers);
  }
  if (needs_system()) return solve_step(numbers, bound);
  MoveNumbers<Real> how = {.fraction = 0,
                           .own_kind = options_.conventions == Conventions::recommended,
                           .mean_edge_squared = static_cast<Real>(mean_edge_ * mean_edge_),
                           .prescribed = numbers.prescribed};
  if (numbers.prescribed) smooth_values(how);
  Outcome outcome;
  outcome.time_step = time_step;
  outcome.in_bounds = move(how, bound);
  return outcome;
}

/// H_A − f̃ V_A on the old surface, then the system.
template <class Real>
PackedFlow::Outcome Flow<Real>::solve_step(const StepNumbers<Real>& numbers, double bound) {
  if (numbers.prescribed) {
    MoveNumbers<Real> how = {.fraction = static_cast<Real>(options_.curvature_smoothing.fraction),
                             .own_kind = options_.conventions == Conventions::recommended,
                             .mean_edge_squared = static_cast<Real>(mean_edge_ * mean_edge_),
                             .prescribed = true};
    for (int i = 0; i < options_.curvature_smoothing.passes; ++i) average_values(how);
  }
  std::vector<Quad<double>> velocity(packed_.slot_count());
  for (std::size_t slot = 0; slot < velocity.size(); ++slot) {
    const Quad<Real>& h = curvature_[slot];
    const Quad<Real>& v = direction_[slot];
    const Real f = numbers.prescribed ? value_[slot] : Real{0};
    velocity[slot] = {static_cast<double>(h.x - f * v.x), static_cast<double>(h.y - f * v.y),
                      static_cast<double>(h.z - f * v.z), 0.0};
  }
  for (const Index slot : held_) velocity[slot] = {};
  // Edges of groups too small for a feature carry no weight.
  const auto clear = [this](Index p, Index q) {
    const Slice& slice = packed_.slices()[p / kLanes];
    for (Index k = 0; k < slice.valence; ++k) {
      const std::size_t at = std::size_t{slice.columns} + k;
      if (packed_.ring()[kLanes * at + p % kLanes] != q) continue;
      strong_[at] = static_cast<std::uint8_t>(strong_[at] & ~(1U << p % kLanes));
    }
  };
  for (const StrongEdge& edge : groups_.noise()) {
    clear(edge.p, edge.q);
    clear(edge.q, edge.p);
  }
  return move_by_solution(velocity, numbers, bound);
}

/// (M + s K_A) δ = −s (K_A P − f̃ V_A), or M δ = −s (…) for explicit steps. An unsolved system is
/// tried again with half the step.
template <class Real>
PackedFlow::Outcome Flow<Real>::move_by_solution(std::span<const Quad<double>> velocity,
                                                 const StepNumbers<Real>& numbers, double bound) {
  if constexpr (std::is_same_v<Real, float>) {
    return {.in_bounds = true, .solved = false};  // create() never makes a single-precision one
  } else {
    if (!system_) system_.emplace(packed_, team_);
    const bool implicit = options_.integration == Integration::semi_implicit;
    Outcome outcome;
    outcome.solved = false;
    outcome.time_step = numbers.time_step;
    std::vector<Quad<double>> b(velocity.size());
    std::vector<Quad<double>> delta;
    for (int halvings = 0; halvings <= kMostHalvings && !outcome.solved; ++halvings) {
      if (halvings > 0) outcome.time_step *= 0.5;
      const double s = outcome.time_step;
      system_->assemble(x_, strong_, held_,
                        {.time_step = implicit ? s : 0.0,
                         .lambda = numbers.lambda,
                         .transition = numbers.transition,
                         .mass = options_.mass.value_or(Mass::full)});
      for (std::size_t i = 0; i < b.size(); ++i) {
        b[i] = {-s * velocity[i].x, -s * velocity[i].y, -s * velocity[i].z, 0.0};
      }
      const SolverReport solved = system_->solve(b, kSolverTolerance, kSolverIterations, delta);
      outcome.solver_iterations += solved.iterations;
      outcome.solver_residual = solved.residual;
      outcome.solved = solved.converged;
    }
    if (!outcome.solved) return outcome;
    double largest = 0.0;
    for (std::size_t i = 0; i < delta.size(); ++i) {
      next_[i] = {x_[i].x + delta[i].x, x_[i].y + delta[i].y, x_[i].z + delta[i].z, 0.0};
      for (const double c : {next_[i].x, next_[i].y, next_[i].z}) {
        largest = std::abs(c) <= largest ? largest : std::abs(c);
      }
    }
    outcome.in_bounds = largest <= bound;
    if (outcome.in_bounds) x_.swap(next_);
    return outcome;
  }
}

template <class Real>
std::vector<unsigned char> Flow<Real>::features() const {
  std::vector<unsigned char> out(packed_.slot_of_vertex().size(), 0);
  for (const Index slot : groups_.features()) out[packed_.vertex_of_slot()[slot]] = 1;
  return out;
}

template <class Real>
std::size_t Flow<Real>::kernel_bytes() const {
  const std::size_t slots = packed_.slot_count();
  return slots * (sizeof(Stored<Real>) + 3 * sizeof(Quad<Real>) + sizeof(Real)) + strong_.size() +
         other_value_.size() * sizeof(Real) + groups_.bytes();
}

template <class Real>
std::vector<Vec3> Flow<Real>::positions(std::span<const Vec3> start) const {
  std::vector<Vec3> out(start.begin(), start.end());
  const double scale = mean_edge_ * quantum_;
  for (std::size_t v = 0; v < out.size(); ++v) {
    const Stored<Real>& p = x_[packed_.slot_of_vertex()[v]];
    const Stored<Real>& s = start_[packed_.slot_of_vertex()[v]];
    out[v] += scale * Vec3(static_cast<double>(p.x) - static_cast<double>(s.x),
                           static_cast<double>(p.y) - static_cast<double>(s.y),
                           static_cast<double>(p.z) - static_cast<double>(s.z));
  }
  return out;
}

}  // namespace

std::unique_ptr<PackedFlow> PackedFlow::create(const TriangleMesh& mesh,
                                               std::span<const Vec3> positions, double mean_edge,
                                               std::span<const unsigned char> held,
                                               const FlowOptions& options,
                                               const Execution& execution) {
  using enum Execution::Precision;
  // The isotropic flow can amplify a rounding error a thousand times in ten steps.
  const bool sensitive =
      mesh.vertex_count() <= kDoubleVertices || options.method == Method::mean_curvature;
  const bool in_double =
      execution.precision == double_precision || (execution.precision == automatic && sensitive);
  if (in_double)
    return std::make_unique<Flow<double>>(mesh, positions, mean_edge, held, options, execution);
  return std::make_unique<Flow<float>>(mesh, positions, mean_edge, held, options, execution);
}

}  // namespace fairway
