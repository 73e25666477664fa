#pragma once

#include <span>
#include <string_view>

#include "core/result.h"
#include "tests/figures/figure.h"

namespace fairway {

/// An experiment of the paper that ends in a picture.
struct Experiment {
  std::string_view name;  ///< as given on the command line
  Result<Figure> (*run)();
};

/// All of them, in the order of the paper, then the README's picture.
std::span<const Experiment> experiments();

}  // namespace fairway
