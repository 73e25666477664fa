#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace fairway {

/// Red, green, blue; 0 … 255, as displayed (sRGB).
struct Rgb {
  std::uint8_t r = 255, g = 255, b = 255;
  bool operator==(const Rgb&) const = default;
};

/// A picture; rows from the top. White at first.
class Image {
 public:
  Image(int width, int height)
      : width_(width), height_(height), pixels_(static_cast<std::size_t>(width * height)) {}

  int width() const { return width_; }
  int height() const { return height_; }
  /// x to the right, y down; within the picture.
  Rgb& at(int x, int y) { return pixels_[static_cast<std::size_t>(y * width_ + x)]; }
  const Rgb& at(int x, int y) const { return pixels_[static_cast<std::size_t>(y * width_ + x)]; }

  /// Copies `other` with its top left corner at (x, y); what does not fit is cut off.
  void paste(const Image& other, int x, int y);

 private:
  int width_;
  int height_;
  std::vector<Rgb> pixels_;
};

/// Means of blocks of `factor` × `factor` pixels; both sides must be multiples of `factor`.
Image shrunk(const Image& image, int factor);

/// Writes ASCII text with its top left corner at (x, y); letters are 5 × 7 dots of `scale` pixels,
/// 6 dots apart. What does not fit is cut off.
void draw_text(Image& image, int x, int y, std::string_view text, int scale,
               Rgb colour = {0, 0, 0});

/// Width of the text in pixels.
int text_width(std::string_view text, int scale);

/// Writes a PNG file (24 bit). Error io.
Result<void> write_png(const Image& image, const std::filesystem::path& path);

}  // namespace fairway
