#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace fairway {

/// Most ranges of one request.
inline constexpr std::size_t kMaxRanges = 8;

/// Bytes `first` to `last`, both included; last < size of the representation.
struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t last = 0;

  std::uint64_t size() const { return last - first + 1; }
};

/// The parts that a Range header asks for, of `bytes` > 0 in all. None: the header is to be
/// ignored, because its unit is not bytes or it does not parse (RFC 9110, 14.2). Ranges beyond the
/// end are left out where others are not. Errors: range_not_satisfiable (all are beyond the end;
/// more than kMaxRanges; they overlap, or do not ascend).
Result<std::vector<ByteRange>> parse_range(std::string_view value, std::uint64_t bytes);

}  // namespace fairway
