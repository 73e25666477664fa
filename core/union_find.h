#pragma once

#include <numeric>
#include <utility>
#include <vector>

#include "core/mesh.h"

namespace fairway {

/// Disjoint sets of 0 … size − 1. The representative of a set is its smallest member.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }

  Index find(Index x) {
    while (parent_[x] != x) {
      parent_[x] = parent_[parent_[x]];
      x = parent_[x];
    }
    return x;
  }

  void unite(Index a, Index b) { unite_root(find(a), b); }

  /// The same for a representative `a`. Returns that of the set of both.
  Index unite_root(Index a, Index b) {
    b = find(b);
    if (a > b) std::swap(a, b);
    parent_[b] = a;
    return a;
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace fairway
