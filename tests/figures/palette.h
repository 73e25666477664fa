#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/result.h"
#include "tests/figures/image.h"

namespace fairway {

/// A picture of few colours: `places` has an index into `colours` for each pixel, rows from the
/// top.
struct PaletteImage {
  int width = 0;
  int height = 0;
  std::vector<Rgb> colours;
  std::vector<std::uint8_t> places;
};

/// The picture in at most `most` colours, 1 to 256, by median cut (Heckbert 1982): a box of colours
/// is halved at its median along its longest side, the one with the most to gain first.
PaletteImage with_palette(const Image& image, std::size_t most);

/// Writes a PNG file with a palette, a third as large as one in 24 bit. Error io.
Result<void> write_png(const PaletteImage& image, const std::filesystem::path& path);

}  // namespace fairway
