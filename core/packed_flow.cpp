// The flows on packed kernels: what moves through them in which order. Source: Hildebrandt &
// Polthier 2004, eqs. (6)–(13).

#include "core/packed_flow.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "core/fixed_point.h"
#include "core/median.h"
#include "core/packed_mesh.h"
#include "core/packed_roughness.h"
#include "core/strong_groups.h"
#include "core/system_step.h"
#include "core/thread_team.h"

namespace fairway {
namespace {

constexpr std::size_t kGrain = 256;  // slices per range
// Where there are more, bends and displacements are looked at in this many even places, each of a
// few slices in a row: with 4 096 vertices a median or a mean square is known to about one percent.
constexpr std::size_t kSampledPlaces = 128;
constexpr std::size_t kSlicesPerPlace = 4;
constexpr std::size_t kDoubleVertices = 20'000;
// |N0 − N1|² of an edge bent by 120°.
constexpr double kFolded = 3.0;
constexpr double kMedianOfNormal = 0.6745;
constexpr double kEdgesAtOnce = 8.0;
// In mean edges: below it every edge is strong, and 1 / λ² must stay a number.
constexpr double kLeastLambda = 1e-12;

/// Everything but a lumped explicit step solves a linear system.
bool solves_system(const FlowOptions& options) {
  return options.integration == Integration::semi_implicit || options.mass == Mass::full;
}

template <class Real>
using Stored = Quad<typename StoredCoordinate<Real>::Type>;

template <class Real>
class Flow final : public PackedFlow {
 public:
  Flow(const TriangleMesh& mesh, std::span<const Vec3> positions, double mean_edge,
       std::span<const unsigned char> held, const FlowOptions& options, const Execution& execution);

  /// Whether positions in fixed point serve this surface.
  bool fixed_point_serves();

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
  StepNumbers<Real> step_numbers(double lambda, double time_step) const;
  MoveNumbers<Real> move_numbers() const;
  void make_fields(bool prescribed);
  void compute_curvature(const StepNumbers<Real>& numbers);
  void find_features();
  void prescribe_features(const StepNumbers<Real>& numbers);
  void average_values(const MoveNumbers<Real>& numbers, int passes);
  template <class Kernel>
  double move_by(double bound, const Kernel& kernel);
  double contract(const StepNumbers<Real>& numbers, double bound);
  double move(double bound);
  Outcome solve_step(const StepNumbers<Real>& numbers, double& largest);
  void coarsen();
  /// Calls body(first slice, last slice) for all slices, by ranges.
  template <class Body>
  void for_slices(const Body& body) {
    team_.for_ranges(packed_.slices().size(), kGrain, [&](std::size_t first, std::size_t last) {
      body(static_cast<Index>(first), static_cast<Index>(last));
    });
  }
  /// Calls body(first slice, last slice) for the sampled places, all of a small surface.
  template <class Body>
  void for_sample(const Body& body) const {
    const std::size_t slices = packed_.slices().size();
    if (slices <= kSampledPlaces * kSlicesPerPlace)
      return body(Index{0}, static_cast<Index>(slices));
    for (std::size_t i = 0; i < kSampledPlaces; ++i) {
      const auto first = static_cast<Index>(i * (slices - kSlicesPerPlace) / (kSampledPlaces - 1));
      body(first, static_cast<Index>(first + kSlicesPerPlace));
    }
  }

  PackedMesh packed_;
  const FlowOptions options_;
  const Isa isa_;
  const FlowKernels<Real>& kernels_;
  ThreadTeam team_;
  double mean_edge_;
  double quantum_ = 1.0;
  std::vector<Stored<Real>> x_, next_, start_;
  std::vector<Quad<Real>> curvature_, direction_;  // where the method needs them
  std::vector<Quad<Real>> start_normals_;          // of the sampled slices
  std::size_t sampled_ = 0;                        // vertices there that may move
  std::vector<Real> value_, other_value_;
  std::vector<std::uint8_t> strong_;    // by column, and padding
  std::vector<std::uint8_t> features_;  // by slice
  std::vector<Index> held_;             // slots
  StrongGroups groups_;
  std::optional<SystemStep> system_;
};

template <class Real>
Flow<Real>::Flow(const TriangleMesh& mesh, std::span<const Vec3> positions, double mean_edge,
                 std::span<const unsigned char> held, const FlowOptions& options,
                 const Execution& execution)
    : packed_(mesh),
      options_(options),
      isa_(execution.isa),
      kernels_(flow_kernels<Real>(isa_)),
      team_(execution.threads),
      mean_edge_(mean_edge) {
  if constexpr (std::is_same_v<Real, float>) {
    double largest = 0.0;
    for (const Vec3& p : positions) largest = std::max(largest, p.cwiseAbs().maxCoeff());
    quantum_ = fixed_point_unit(largest / mean_edge);
  }
  const std::size_t slots = packed_.slot_count();
  x_.resize(slots, {});
  next_.resize(slots);
  strong_.resize(packed_.column_count() + PackedMesh::kPadding);
  const double scale = 1.0 / (mean_edge * quantum_);
  for (std::size_t slot = 0; slot < slots; ++slot) {
    const Index v = packed_.vertex_of_slot()[slot];
    if (v == kNoIndex) continue;
    const Vec3 p = positions[v] * scale;
    if constexpr (std::is_same_v<Real, float>) {
      x_[slot] = {nearest_unit(p.x()), nearest_unit(p.y()), nearest_unit(p.z()), 0};
    } else {
      x_[slot] = {p.x(), p.y(), p.z(), 0.0};
    }
    if (held[v] != 0) held_.push_back(static_cast<Index>(slot));
  }
}

template <class Real>
bool Flow<Real>::fixed_point_serves() {
  if (quantum_ > fixed_point_unit(kLargestFixedPoint)) return false;
  std::vector<Real> parts((packed_.slices().size() + kGrain - 1) / kGrain);
  for_slices([&](Index first, Index last) {
    parts[first / kGrain] = kernels_.least_height(kernel_mesh(), first, last);
  });
  return *std::min_element(parts.begin(), parts.end()) >= static_cast<Real>(kLeastFixedPointHeight);
}

template <class Real>
PackedFlow::Bends Flow<Real>::bends(bool sampled) {
  std::vector<Real> values;
  const auto look = [&](Index first, Index last) {
    const Slice& final = packed_.slices()[last - 1];
    const std::size_t columns = final.columns + final.valence - packed_.slices()[first].columns;
    const std::size_t before = values.size();
    values.resize(before + kLanes * columns);
    kernels_.bends(kernel_mesh(), first, last, values.data() + before);
  };
  if (sampled) {
    for_sample(look);
  } else {
    look(0, static_cast<Index>(packed_.slices().size()));
  }
  const auto [median, largest] = median_and_largest(values);
  if (largest < 0) return {};
  const double squared = static_cast<double>(median);
  return {2.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(squared))) / kMedianOfNormal,
          largest > static_cast<Real>(kFolded)};
}

/// The fields beyond those of a flow that moves in one pass.
template <class Real>
void Flow<Real>::make_fields(bool prescribed) {
  curvature_.resize(packed_.slot_count());
  if (!prescribed) return;
  direction_.resize(packed_.slot_count());
  value_.resize(packed_.slot_count());
}

template <class Real>
void Flow<Real>::compute_curvature(const StepNumbers<Real>& numbers) {
  make_fields(numbers.prescribed);
  for_slices([&](Index first, Index last) {
    kernels_.curvature(kernel_mesh(), numbers, fields(), first, last);
  });
  for (const Index slot : held_) curvature_[slot].w = 0;
}

template <class Real>
double Flow<Real>::roughness() {
  StepNumbers<Real> numbers = step_numbers(1.0, 1.0);
  numbers.lambda = std::numeric_limits<Real>::infinity();
  numbers.prescribed = true;
  compute_curvature(numbers);
  // h = ⟨N, H⟩ / M.
  std::vector<double> h(packed_.slot_count());
  for (std::size_t slot = 0; slot < h.size(); ++slot) {
    const Quad<Real>& v = direction_[slot];
    const Quad<Real>& c = curvature_[slot];
    const Real size = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    if (size > 0) {
      h[slot] = static_cast<double>((c.x * v.x + c.y * v.y + c.z * v.z) / size * v.w);
    }
  }
  return roughness_of(packed_, h);
}

template <class Real>
void Flow<Real>::mark_start() {
  start_ = x_;
  start_normals_.clear();
  sampled_ = 0;
  for_sample([&](Index first, Index last) {
    const std::size_t before = start_normals_.size();
    start_normals_.resize(before + kLanes * std::size_t{last - first});
    kernels_.normals(kernel_mesh(), first, last, start_normals_.data() + before);
    for (Index slot = kLanes * first; slot < kLanes * last; ++slot) {
      const bool may_move = packed_.vertex_of_slot()[slot] != kNoIndex &&
                            !std::binary_search(held_.begin(), held_.end(), slot);
      sampled_ += may_move ? 1 : 0;
    }
  });
}

template <class Real>
double Flow<Real>::displacement() {
  double sum = 0.0;
  const Quad<Real>* normals = start_normals_.data();
  for_sample([&](Index first, Index last) {
    sum += kernels_.displacement(kernel_mesh(), start_.data(), normals, first, last);
    normals += kLanes * std::size_t{last - first};
  });
  return sampled_ > 0 ? std::sqrt(sum / static_cast<double>(sampled_)) : 0.0;
}

template <class Real>
StepNumbers<Real> Flow<Real>::step_numbers(double lambda, double time_step) const {
  return {.time_step = static_cast<Real>(time_step),
          .lambda = is_anisotropic(options_.method)
                        ? static_cast<Real>(std::max(lambda, kLeastLambda))
                        : std::numeric_limits<Real>::infinity(),
          .transition = static_cast<Real>(options_.transition),
          .local_step = options_.guards.local_step,
          .prescribed = is_prescribed(options_.method),
          .measure = static_cast<KernelMeasure>(options_.measure),
          .all_neighbours = options_.conventions == Conventions::paper};
}

template <class Real>
MoveNumbers<Real> Flow<Real>::move_numbers() const {
  return {.fraction = static_cast<Real>(options_.curvature_smoothing.fraction),
          .own_kind = options_.conventions == Conventions::recommended,
          .mean_edge_squared = static_cast<Real>(mean_edge_ * mean_edge_),
          .prescribed = is_prescribed(options_.method)};
}

/// Which strong edges are features; the others are noise, and have no more to them than any edge.
template <class Real>
void Flow<Real>::find_features() {
  groups_.find(packed_, strong_, options_.guards.min_component, features_);
}

/// V_A and f at feature vertices.
template <class Real>
void Flow<Real>::prescribe_features(const StepNumbers<Real>& numbers) {
  // Kinds first: who averages with whom depends on them.
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  for (std::size_t slice = 0; slice < features_.size(); ++slice) {
    for (unsigned lanes = features_[slice]; lanes != 0; lanes &= lanes - 1) {
      Real& f = value_[kLanes * slice + static_cast<unsigned>(std::countr_zero(lanes))];
      f = std::bit_cast<Real>(std::bit_cast<Bits>(f) | Bits{1});
    }
  }
  for_slices([&](Index first, Index last) {
    kernels_.direct(kernel_mesh(), numbers, fields(), features_.data(), first, last);
  });
  for_slices([&](Index first, Index last) {
    kernels_.revalue(numbers, fields(), features_.data(), first, last);
  });
}

template <class Real>
void Flow<Real>::average_values(const MoveNumbers<Real>& numbers, int passes) {
  if (passes > 0) other_value_.resize(value_.size());
  for (int pass = 0; pass < passes; ++pass) {
    for_slices([&](Index first, Index last) {
      kernels_.average(kernel_mesh(), numbers, value_.data(), first, last, other_value_.data());
    });
    value_.swap(other_value_);
  }
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

/// The larger, and NaN if either is.
double larger(double a, double b) {
  return a >= b || std::isnan(a) ? a : b;
}

/// Moves all slots by kernel(first, last), which fills next_ and answers the largest coordinate.
/// Returns that of all in L; NaN or infinity if one is not finite.
template <class Real>
template <class Kernel>
double Flow<Real>::move_by(double bound, const Kernel& kernel) {
  std::vector<Real> parts((packed_.slices().size() + kGrain - 1) / kGrain);
  for (;;) {
    for_slices([&](Index first, Index last) { parts[first / kGrain] = kernel(first, last); });
    double largest = 0.0;
    for (const Real part : parts) largest = larger(static_cast<double>(part), largest);
    const bool fits = std::is_same_v<Real, double> || largest <= kMostFixedPointUnits;
    if (fits || !(largest * quantum_ <= bound)) return largest * quantum_;
    coarsen();
  }
}

/// A mean curvature flow step in one pass; then features take back what moved them. Returns like
/// move_by().
template <class Real>
double Flow<Real>::contract(const StepNumbers<Real>& numbers, double bound) {
  double largest = move_by(bound, [&](Index first, Index last) {
    return kernels_.contract(kernel_mesh(), numbers, fields(), first, last, next_.data());
  });
  for (const Index slot : held_) {
    next_[slot] = x_[slot];
    next_[slot].w = 0;
  }
  if (!is_anisotropic(options_.method) || !(largest <= bound)) return largest;
  find_features();
  double most = 0.0;
  for_feature_edges(packed_, strong_, features_, [&](const StrongEdges& edges) {
    most = larger(
        static_cast<double>(kernels_.weaken_moved(kernel_mesh(), numbers, edges, next_.data())),
        most);
  });
  // Rather too large than too small: by several edges of a vertex at once.
  largest += kEdgesAtOnce * most * quantum_;
  if (std::is_same_v<Real, double> || largest <= kMostFixedPointUnits * quantum_ ||
      !(largest <= bound)) {
    return largest;
  }
  coarsen();
  return contract(numbers, bound);
}

/// A prescribed mean curvature flow step from the fields. Returns like move_by().
template <class Real>
double Flow<Real>::move(double bound) {
  MoveNumbers<Real> how = move_numbers();
  const int passes = options_.curvature_smoothing.passes;
  average_values(how, passes - 1);
  if (passes == 0) how.fraction = 0;
  return move_by(bound, [&](Index first, Index last) {
    return kernels_.move(kernel_mesh(), how, fields(), first, last, next_.data());
  });
}

template <class Real>
PackedFlow::Outcome Flow<Real>::step(double lambda, double time_step, double bound) {
  const StepNumbers<Real> numbers = step_numbers(lambda, time_step);
  Outcome outcome;
  outcome.time_step = time_step;
  double largest = 0.0;
  if (!solves_system(options_) && !numbers.prescribed) {
    largest = contract(numbers, bound);
  } else {
    compute_curvature(numbers);
    if (is_anisotropic(options_.method)) {
      find_features();
      for_feature_edges(packed_, strong_, features_, [&](const StrongEdges& edges) {
        kernels_.weaken(kernel_mesh(), numbers, edges, curvature_.data());
      });
      if (numbers.prescribed) prescribe_features(numbers);
    }
    if (solves_system(options_)) {
      outcome = solve_step(numbers, largest);
    } else {
      largest = move(bound);
    }
  }
  outcome.in_bounds = largest <= bound;
  outcome.finite = std::isfinite(largest);
  if (outcome.in_bounds && outcome.solved) x_.swap(next_);
  return outcome;
}

/// H_A − f̃ V_A on the old surface, then the system. `largest` like that of move_by().
template <class Real>
PackedFlow::Outcome Flow<Real>::solve_step(const StepNumbers<Real>& numbers, double& largest) {
  if constexpr (std::is_same_v<Real, float>) {
    (void)numbers;
    (void)largest;
    return {.solved = false};  // create() never makes a single-precision one
  } else {
    if (numbers.prescribed) average_values(move_numbers(), options_.curvature_smoothing.passes);
    if (is_anisotropic(options_.method)) {
      // Edges that are no features carry the weight 1 in the system too.
      for (std::size_t s = 0; s < features_.size(); ++s) {
        const Slice& slice = packed_.slices()[s];
        for (Index k = 0; k < slice.valence; ++k) strong_[slice.columns + k] &= features_[s];
      }
    }
    if (!system_) system_.emplace(packed_, team_, isa_);
    const Outcome outcome = system_->solve(x_, fields(), held_, numbers, options_);
    if (!outcome.solved) return outcome;
    const std::span<const Quad<double>> delta = system_->displacement();
    for (std::size_t i = 0; i < delta.size(); ++i) {
      next_[i] = {x_[i].x + delta[i].x, x_[i].y + delta[i].y, x_[i].z + delta[i].z, 0.0};
      for (const double c : {next_[i].x, next_[i].y, next_[i].z}) {
        largest = larger(std::abs(c), largest);
      }
    }
    return outcome;
  }
}

template <class Real>
std::vector<unsigned char> Flow<Real>::features() const {
  std::vector<unsigned char> out(packed_.slot_of_vertex().size(), 0);
  if (features_.empty()) return out;
  for (std::size_t v = 0; v < out.size(); ++v) {
    const Index slot = packed_.slot_of_vertex()[v];
    out[v] = features_[slot / kLanes] >> slot % kLanes & 1U;
  }
  return out;
}

template <class Real>
std::size_t Flow<Real>::kernel_bytes() const {
  return next_.capacity() * sizeof(Stored<Real>) +
         (curvature_.capacity() + direction_.capacity() + start_normals_.capacity()) *
             sizeof(Quad<Real>) +
         (value_.capacity() + other_value_.capacity()) * sizeof(Real) + strong_.capacity() +
         features_.capacity() + groups_.bytes();
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
  const auto in_double = [&] {
    return std::make_unique<Flow<double>>(mesh, positions, mean_edge, held, options, execution);
  };
  // Linear systems need it, and the isotropic flow amplifies a rounding error a thousand times in
  // ten steps.
  const bool sensitive =
      options.method == Method::mean_curvature || mesh.vertex_count() <= kDoubleVertices;
  const bool chooses = execution.precision == automatic;
  if (solves_system(options) || execution.precision == double_precision || (chooses && sensitive)) {
    return in_double();
  }
  auto single = std::make_unique<Flow<float>>(mesh, positions, mean_edge, held, options, execution);
  if (chooses && !single->fixed_point_serves()) return in_double();
  return single;
}

}  // namespace fairway
