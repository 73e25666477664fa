#pragma once

#include <cstddef>
#include <cstdint>

#include "proto/messages/format.h"

namespace fairway {

/// What a run with default parameters costs.
struct CostEstimate {
  int steps = 0;                   ///< of the surface that takes most
  double seconds = 0.0;            ///< of one processor
  std::uint64_t memory_bytes = 0;  ///< at the peak
};

/// Size of what is to be run on, and how far it has to go.
struct CostSubject {
  Format format = Format::glb;
  std::uint64_t bytes = 0;    ///< of the file
  std::size_t vertices = 0;   ///< of the file
  std::size_t triangles = 0;  ///< of the file
  /// Σ of vertices · steps over the surfaces, with the most steps that an automatic run takes: it
  /// may end before.
  double vertex_steps = 0.0;
  int steps = 0;  ///< the most of a surface
};

/// A linear model whose constants were measured, see cost_estimate.cpp; good to a factor of two on
/// a server's processor of 2023 that has nothing else to do. Total.
CostEstimate estimate_cost(const CostSubject& subject);

}  // namespace fairway
