#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <string_view>

#include "proto/formats/bytes.h"

namespace fairway::test {

/// The same numbers on every platform.
using Random = std::mt19937_64;

/// A mutation of `seed`: bits flipped, a field overwritten, bytes cut off, taken out or doubled, or
/// a number of its text replaced. A GLB keeps its framing every other time: its JSON or its BIN
/// chunk is mutated and the lengths are put right.
std::vector<std::byte> mutated(ByteSpan seed, Random& random);

/// `text` with one of its decimal numbers replaced: by a limit, a neighbour, or another number of
/// the text. As it is where there is none.
std::string with_other_number(std::string_view text, Random& random);

}  // namespace fairway::test
