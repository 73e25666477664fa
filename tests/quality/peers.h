#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace fairway::quality {

/// What the best other program reaches on a model with a noise.
struct Peer {
  std::string name;
  double normal_error = 0.0;  ///< degrees
  std::optional<double> mean_distance;
  std::optional<std::size_t> flipped, degenerate;
};

/// The best with its own settings, and the best with any setting, chosen with the clean mesh.
struct Peers {
  std::optional<Peer> standard, tuned;
};

/// By model and noise, from peers.json; empty, said plainly, where that is absent.
std::map<std::pair<std::string, std::string>, Peers> read_peers(const std::filesystem::path& file);

}  // namespace fairway::quality
