// Assembly by edges, conjugate gradients by rows.

#include "core/stencil_system.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fairway {
namespace {

constexpr std::size_t kRange = 2048;
constexpr std::size_t kBlock = 64;  // slots whose products are added up in single precision
constexpr float kLeastDiagonal = 1e-20F;

/// Σ term(v) over [first, last): blocks in single precision, these in double.
template <class Term>
Eigen::Vector4d sum_blocks(std::size_t first, std::size_t last, const Term& term) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  while (first < last) {
    const std::size_t end = std::min(last, first + kBlock);
    Four block = Four::Zero();
    for (; first < end; ++first) block += term(first);
    sum += block.matrix().cast<double>();
  }
  return sum;
}

Eigen::Vector4d total(const std::vector<Eigen::Vector4d>& parts) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const Eigen::Vector4d& part : parts) sum += part;
  return sum;
}

/// a / b per column, 0 where b is not positive.
Four ratio(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
  Four out = Four::Zero();
  for (int k = 0; k < 4; ++k) {
    if (b[k] > 0.0) out[k] = static_cast<float>(a[k] / b[k]);
  }
  return out;
}

}  // namespace

StencilSystem::StencilSystem(const EdgeStencils& mesh, std::span<const unsigned char> held,
                             ThreadTeam& team)
    : mesh_(mesh), held_(held.begin(), held.end()), team_(team), offsets_(held.size() + 1, 0) {
  const auto count = [this](Index a, Index b) {
    ++offsets_[a + 1];
    ++offsets_[b + 1];
  };
  for (const auto& [p, q] : mesh.edges()) count(p, q);
  for (const EdgeStencil& s : mesh.stencils()) count(s.points[2], s.points[3]);
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
  columns_.resize(offsets_.back());
  entries_.resize(offsets_.back());
  std::vector<Index> next(offsets_.begin(), offsets_.end() - 1);
  const auto place = [&](Index a, Index b) {
    columns_[next[a]] = b;
    columns_[next[b]] = a;
    return std::array{next[a]++, next[b]++};
  };
  places_of_edge_.reserve(mesh.edges().size());
  places_of_stencil_.reserve(mesh.stencils().size());
  for (const auto& [p, q] : mesh.edges()) places_of_edge_.push_back(place(p, q));
  for (const EdgeStencil& s : mesh.stencils()) {
    places_of_stencil_.push_back(place(s.points[2], s.points[3]));
  }
  edge_values_.resize(mesh.edges().size());
  opposite_values_.resize(mesh.stencils().size());
  for (auto* numbers : {&diagonal_, &scale_}) numbers->resize(held_.size());
  for (auto* vector : {&x_, &r_, &direction_, &image_}) vector->resize(held_.size());
  parts_.resize((held_.size() + kRange - 1) / kRange);
}

void StencilSystem::begin(std::span<const double> data) {
  std::fill(edge_values_.begin(), edge_values_.end(), 0.0F);
  for (std::size_t v = 0; v < data.size(); ++v) diagonal_[v] = static_cast<float>(data[v]);
}

void StencilSystem::add(std::size_t stencil, const std::array<float, 4>& c, float bend,
                        float fair) {
  const EdgeStencil& s = mesh_.stencils()[stencil];
  for (std::size_t k = 0; k < 4; ++k) diagonal_[s.points[k]] += bend * c[k] * c[k] + fair;
  edge_values_[s.edge] += bend * c[0] * c[1] + fair;
  opposite_values_[stencil] = bend * c[2] * c[3] + fair;
  constexpr std::array<std::array<std::size_t, 2>, 4> kEnds = {{{0, 2}, {1, 2}, {0, 3}, {1, 3}}};
  for (std::size_t k = 0; k < 4; ++k) {
    if (s.sides[k] == kNoIndex) continue;
    edge_values_[s.sides[k]] += bend * c[kEnds[k][0]] * c[kEnds[k][1]] - fair;
  }
}

/// Scales to a unit diagonal and parts held slots from the others.
void StencilSystem::finish() {
  for (std::size_t v = 0; v < scale_.size(); ++v) {
    scale_[v] = held_[v] != 0 ? 0.0F : 1.0F / std::sqrt(std::max(diagonal_[v], kLeastDiagonal));
  }
  const auto put = [this](const std::array<Index, 2>& places, float value, Index a, Index b) {
    entries_[places[0]] = entries_[places[1]] = value * scale_[a] * scale_[b];
  };
  team_.for_ranges(edge_values_.size(), 2 * kRange, [&](std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) {
      put(places_of_edge_[e], edge_values_[e], mesh_.edges()[e][0], mesh_.edges()[e][1]);
    }
  });
  team_.for_ranges(opposite_values_.size(), 2 * kRange, [&](std::size_t first, std::size_t last) {
    for (std::size_t s = first; s < last; ++s) {
      const EdgeStencil& stencil = mesh_.stencils()[s];
      put(places_of_stencil_[s], opposite_values_[s], stencil.points[2], stencil.points[3]);
    }
  });
}

/// Residual and direction; returns |r|².
Eigen::Vector4d StencilSystem::start(std::span<const Vec4> r) {
  team_.for_ranges(r.size(), kRange, [&](std::size_t first, std::size_t last) {
    parts_[first / kRange] = sum_blocks(first, last, [&](std::size_t v) -> Four {
      r_[v] = (r[v] * static_cast<double>(scale_[v])).cast<float>().array();
      direction_[v] = r_[v];
      x_[v].setZero();
      return r_[v].square();
    });
  });
  return total(parts_);
}

/// The image of the direction; returns their product.
Eigen::Vector4d StencilSystem::search() {
  team_.for_ranges(r_.size(), kRange, [&](std::size_t first, std::size_t last) {
    const Index* column = columns_.data() + offsets_[first];
    const float* entry = entries_.data() + offsets_[first];
    parts_[first / kRange] = sum_blocks(first, last, [&](std::size_t v) -> Four {
      Four sum = direction_[v];
      for (const Index* end = columns_.data() + offsets_[v + 1]; column < end; ++column, ++entry) {
        sum += *entry * direction_[*column];
      }
      image_[v] = sum;
      return sum * direction_[v];
    });
  });
  return total(parts_);
}

/// Solution and residual; returns |r|².
Eigen::Vector4d StencilSystem::advance(const Four& length) {
  team_.for_ranges(r_.size(), kRange, [&](std::size_t first, std::size_t last) {
    parts_[first / kRange] =
        sum_blocks(first, last,
                   [step = length, x = x_.data(), r = r_.data(), direction = direction_.data(),
                    image = image_.data()](std::size_t v) -> Four {
                     x[v] += step * direction[v];
                     const Four left = r[v] - step * image[v];
                     r[v] = left;
                     return left.square();
                   });
  });
  return total(parts_);
}

int StencilSystem::correct(std::span<const Vec4> r, const Goal& goal, std::span<Vec4> x) {
  finish();
  Eigen::Vector4d rho = start(r);
  int iteration = 0;
  while (iteration < goal.most_iterations &&
         !(rho.head<3>().sum() <= goal.coordinates && rho[3] <= goal.probe)) {
    const Eigen::Vector4d next = advance(ratio(rho, search()));
    const Four keep = ratio(next, rho);
    team_.for_ranges(r_.size(), kRange, [&](std::size_t first, std::size_t last) {
      for (std::size_t v = first; v < last; ++v) direction_[v] = r_[v] + keep * direction_[v];
    });
    rho = next;
    ++iteration;
  }
  for (std::size_t v = 0; v < x.size(); ++v) {
    x[v] += (x_[v] * scale_[v]).matrix().cast<double>();
  }
  return iteration;
}

}  // namespace fairway
