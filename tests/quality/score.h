#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/quality/peers.h"
#include "tests/quality/reference_surface.h"

namespace fairway::quality {

/// One run.
struct Score {
  std::string model, noise;
  int seed = 0;
  bool sharp = false;
  std::size_t vertices = 0;
  Comparison result = {};
  double moved = 0.0;  ///< rms, from the noisy mesh, in mean edges
  double seconds = 0.0;
  std::string noise_found = {}, chosen = {};
  Peers peers = {};
  std::optional<double> best_on_path = {};
};

void print_head();
void print(const Score& score);
/// In how many cases we are as good as the peers, and how far below them.
void print_summary(const std::vector<Score>& scores);
nlohmann::json document(const std::vector<Score>& scores);

}  // namespace fairway::quality
