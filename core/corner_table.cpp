// Pairs the sides of faces: a counting sort by the lower end, then matching within each end's few.

#include "core/corner_table.h"

#include <algorithm>
#include <utility>

namespace fairway {
namespace {

/// A side as its lower end sees it.
struct Side {
  Index high;
  Index corner_and_direction;  ///< 2 · corner + (1 if it runs upward)

  Index corner() const { return corner_and_direction >> 1U; }
  bool upward() const { return (corner_and_direction & 1U) != 0; }
};

// Up to here, comparing all pairs beats sorting.
constexpr std::ptrdiff_t kFewSides = 24;

void join(CornerTable& table, const Side& a, const Side& b) {
  table.opposite[a.corner()] = b.corner();
  table.opposite[b.corner()] = a.corner();
}

/// Joins a group of sides between the same two ends, if it is a pair of opposite direction.
void join_group(CornerTable& table, const Side* first, const Side* last) {
  if (last - first == 2 && first[0].upward() != first[1].upward()) {
    join(table, first[0], first[1]);
  } else if (last - first >= 2) {
    table.may_have_duplicates = true;
  }
}

void match_sorted(CornerTable& table, Side* first, Side* last) {
  std::sort(first, last, [](const Side& a, const Side& b) {
    return std::pair(a.high, a.corner_and_direction) < std::pair(b.high, b.corner_and_direction);
  });
  while (first != last) {
    const Side* end =
        std::find_if(first, last, [high = first->high](const Side& s) { return s.high != high; });
    join_group(table, first, end);
    first += end - first;
  }
}

void match_few(CornerTable& table, Side* first, Side* last) {
  while (first != last) {
    // Brings the others of the group to the front.
    Side* end = first + 1;
    for (Side* other = end; other != last; ++other) {
      if (other->high == first->high) std::swap(*end++, *other);
    }
    join_group(table, first, end);
    first = end;
  }
}

}  // namespace

CornerTable corner_table(std::span<const Triangle> faces, std::size_t vertex_count) {
  std::vector<Index> end(vertex_count + 1, 0);
  for (const Triangle& f : faces) {
    ++end[std::min(f[0], f[1])];
    ++end[std::min(f[1], f[2])];
    ++end[std::min(f[2], f[0])];
  }
  Index sum = 0;
  for (Index& e : end) sum = std::exchange(e, sum) + sum;
  std::vector<Side> sides(3 * faces.size());
  for (Index f = 0; f < faces.size(); ++f) {
    for (Index slot = 0; slot < 3; ++slot) {
      const Index a = faces[f][slot];
      const Index b = faces[f][slot == 2 ? 0 : slot + 1];
      sides[end[std::min(a, b)]++] = {std::max(a, b), 2 * (3 * f + slot) + (a < b ? 1 : 0)};
    }
  }
  CornerTable table;
  table.opposite.assign(3 * faces.size(), kNoIndex);
  Side* first = sides.data();
  for (std::size_t v = 0; v < vertex_count; ++v) {
    Side* last = sides.data() + end[v];
    if (last - first <= kFewSides) {
      match_few(table, first, last);
    } else {
      match_sorted(table, first, last);
    }
    first = last;
  }
  // Two faces back to back have three good pairs and are still one face twice.
  for (Index f = 0; f < faces.size() && !table.may_have_duplicates; ++f) {
    const Index other = table.opposite[3 * f] / 3;
    table.may_have_duplicates = table.opposite[3 * f] != kNoIndex &&
                                table.opposite[3 * f + 1] / 3 == other &&
                                table.opposite[3 * f + 2] / 3 == other;
  }
  return table;
}

}  // namespace fairway
