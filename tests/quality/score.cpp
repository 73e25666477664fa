// The table, what it comes to, and the same as JSON.

#include "tests/quality/score.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

namespace fairway::quality {
namespace {

bool few_bad_faces(const Score& s) {
  const Peer& peer = *s.peers.tuned;
  return (!peer.flipped || s.result.flipped <= *peer.flipped) &&
         (!peer.degenerate || s.result.degenerate <= *peer.degenerate);
}

bool mild(const Score& s) {
  return s.sharp && (s.noise == "n0.1" || s.noise == "n0.2" || s.noise == "r0.2");
}

/// "name: 50 of 53 (94.3 %)" and which are not.
void count(const std::string& name, const std::vector<Score>& scores,
           const std::function<bool(const Score&)>& concerns,
           const std::function<bool(const Score&)>& holds) {
  std::size_t all = 0;
  std::size_t good = 0;
  std::string others;
  for (const Score& s : scores) {
    if (!concerns(s)) continue;
    ++all;
    if (holds(s)) {
      ++good;
    } else {
      others += fmt::format(" {}/{}/{}", s.model, s.noise, s.seed);
    }
  }
  if (all == 0) return;
  fmt::print("{}: {} of {} ({:.1f} %){}{}\n", name, good, all,
             100.0 * static_cast<double>(good) / static_cast<double>(all),
             others.empty() ? "" : "; not", others);
}

}  // namespace

void print_head() {
  fmt::print("{:<16}{:<6}{:>4} {:>7}{:>8}{:>9}{:>8}{:>6}{:>6}{:>8}  {:<10} {:<9}{:>7}\n", "model",
             "noise", "seed", "error", "feature", "d 1e-4", "vol %", "flip", "thin", "seconds",
             "noise is", "chosen", "peers: tuned, default; best on path");
}

void print(const Score& s) {
  fmt::print("{:<16}{:<6}{:>4} {:>7.2f}{:>8.2f}{:>9.2f}{:>8.2f}{:>6}{:>6}{:>8.2f}  {:<10} {:<9}",
             s.model, s.noise, s.seed, s.result.normal_error, s.result.feature_error,
             1e4 * s.result.mean_distance, s.result.volume_change.value_or(0.0), s.result.flipped,
             s.result.degenerate, s.seconds, s.noise_found, s.chosen);
  for (const std::optional<Peer>* peer : {&s.peers.tuned, &s.peers.standard}) {
    if (*peer) fmt::print(" {:>5.2f} {}", (*peer)->normal_error, (*peer)->name);
  }
  if (s.best_on_path) fmt::print(" {:>5.2f}", *s.best_on_path);
  fmt::print("\n");
  std::fflush(stdout);
}

void print_summary(const std::vector<Score>& scores) {
  const auto error = [](const Score& s) { return s.result.normal_error; };
  const auto tuned = [](const Score& s) { return s.peers.tuned.has_value(); };
  const auto standard = [](const Score& s) { return s.peers.standard.has_value(); };
  fmt::print("\n");
  count("error <= best tuned peer", scores, tuned,
        [&](const Score& s) { return error(s) <= s.peers.tuned->normal_error; });
  count("error <= best default", scores, standard,
        [&](const Score& s) { return error(s) <= s.peers.standard->normal_error; });
  count("error <= 1.10 best default", scores, standard,
        [&](const Score& s) { return error(s) <= 1.1 * s.peers.standard->normal_error; });
  count(
      "distance <= tuned peer's", scores,
      [&](const Score& s) { return tuned(s) && s.peers.tuned->mean_distance; },
      [](const Score& s) { return s.result.mean_distance <= *s.peers.tuned->mean_distance; });
  count(
      "volume within 0.5 %", scores,
      [](const Score& s) { return s.result.volume_change.has_value(); },
      [](const Score& s) { return std::abs(*s.result.volume_change) <= 0.5; });
  count("bad faces <= tuned peer's", scores, tuned, few_bad_faces);
  count("no bad face on sharp models at 0.1 and 0.2", scores, mild,
        [](const Score& s) { return s.result.flipped + s.result.degenerate == 0; });
  count(
      "error <= 1.15 best on path", scores,
      [](const Score& s) { return s.best_on_path.has_value(); },
      [&](const Score& s) { return error(s) <= 1.15 * *s.best_on_path; });
  count(
      "moved <= 0.05 mean edges", scores, [](const Score& s) { return s.noise == "n0"; },
      [](const Score& s) { return s.moved <= 0.05; });
  double logs = 0.0;
  double cases = 0.0;
  for (const Score& s : scores) {
    if (!tuned(s)) continue;
    logs += std::log(error(s) / s.peers.tuned->normal_error);
    ++cases;
  }
  if (cases > 0.0) {
    fmt::print("geometric mean of error / best tuned peer: {:.3f}\n", std::exp(logs / cases));
  }
}

nlohmann::json document(const std::vector<Score>& scores) {
  nlohmann::json rows = nlohmann::json::array();
  for (const Score& s : scores) {
    nlohmann::json row = {{"model", s.model},
                          {"noise", s.noise},
                          {"seed", s.seed},
                          {"vertices", s.vertices},
                          {"normal_error", s.result.normal_error},
                          {"feature_error", s.result.feature_error},
                          {"mean_distance", s.result.mean_distance},
                          {"largest_distance", s.result.largest_distance},
                          {"flipped", s.result.flipped},
                          {"degenerate", s.result.degenerate},
                          {"moved", s.moved},
                          {"seconds", s.seconds},
                          {"noise_found", s.noise_found},
                          {"chosen", s.chosen}};
    if (s.result.volume_change) row["volume_change"] = *s.result.volume_change;
    if (s.peers.tuned) row["best_tuned"] = s.peers.tuned->normal_error;
    if (s.peers.standard) row["best_default"] = s.peers.standard->normal_error;
    if (s.best_on_path) row["best_on_path"] = *s.best_on_path;
    rows.push_back(std::move(row));
  }
  return {{"rows", std::move(rows)}};
}

}  // namespace fairway::quality
