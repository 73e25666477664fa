#pragma once

#include "tests/figures/image.h"

namespace fairway {

/// The colour of a value in [0, 1] (clipped): light grey, yellow, orange, red, violet, near black.
/// Lightness falls evenly, so that equal steps look equal and the order shows in grey, too; what is
/// flat stays light, so that shading shows on it.
Rgb colour_of(double value);

}  // namespace fairway
