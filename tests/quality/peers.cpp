// Figures of other programs as the shared collection has them.

#include "tests/quality/peers.h"

#include <fstream>
#include <iostream>

#include <nlohmann/json.hpp>

namespace fairway::quality {
namespace {

template <class T>
std::optional<T> number(const nlohmann::json& row, const char* key) {
  const auto found = row.find(key);
  if (found == row.end() || !found->is_number()) return std::nullopt;
  return found->get<T>();
}

void keep_better(std::optional<Peer>& best, const Peer& peer) {
  if (!best || peer.normal_error < best->normal_error) best = peer;
}

}  // namespace

std::map<std::pair<std::string, std::string>, Peers> read_peers(const std::filesystem::path& file) {
  std::map<std::pair<std::string, std::string>, Peers> out;
  std::ifstream in(file);
  if (!in) {
    std::cerr << "quality: no figures of peers, " << file.filename().string() << " is absent\n";
    return out;
  }
  const nlohmann::json document = nlohmann::json::parse(in);
  for (const nlohmann::json& row : document.at("rows")) {
    const auto error = number<double>(row, "mae");
    if (row.at("peer") == "noisy" || !error) continue;
    Peers& peers = out[{row.at("model"), row.at("noise")}];
    const Peer peer{row.at("peer"), *error, number<double>(row, "d_mean"),
                    number<std::size_t>(row, "flipped"), number<std::size_t>(row, "degen")};
    keep_better(row.at("which") == "default" ? peers.standard : peers.tuned, peer);
  }
  for (auto& [key, peers] : out) {
    if (peers.standard) keep_better(peers.tuned, *peers.standard);
  }
  return out;
}

}  // namespace fairway::quality
