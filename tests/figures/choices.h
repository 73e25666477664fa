#pragma once

#include <span>

#include "tests/figures/experiments.h"

namespace fairway {

/// What parameters do, as a caller would state them: for the page that explains them.
std::span<const Experiment> choices();

}  // namespace fairway
