// Pictures in memory and on disk.

#include "tests/figures/image.h"

#include <algorithm>

#include <png.h>

namespace fairway {

void Image::paste(const Image& other, int x, int y) {
  for (int j = std::max(0, -y); j < std::min(other.height_, height_ - y); ++j) {
    for (int i = std::max(0, -x); i < std::min(other.width_, width_ - x); ++i) {
      at(x + i, y + j) = other.at(i, j);
    }
  }
}

Image shrunk(const Image& image, int factor) {
  Image out(image.width() / factor, image.height() / factor);
  const int count = factor * factor;
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      int r = count / 2;
      int g = r;
      int b = r;
      for (int k = 0; k < count; ++k) {
        const Rgb& pixel = image.at(x * factor + k % factor, y * factor + k / factor);
        r += pixel.r;
        g += pixel.g;
        b += pixel.b;
      }
      out.at(x, y) = {static_cast<std::uint8_t>(r / count), static_cast<std::uint8_t>(g / count),
                      static_cast<std::uint8_t>(b / count)};
    }
  }
  return out;
}

Result<void> write_png(const Image& image, const std::filesystem::path& path) {
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Rgb& pixel = image.at(x, y);
      bytes.insert(bytes.end(), {pixel.r, pixel.g, pixel.b});
    }
  }
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width());
  header.height = static_cast<png_uint_32>(image.height());
  header.format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(&header, path.c_str(), 0, bytes.data(), 0, nullptr) == 0) {
    return Error{ErrorCode::io, "Cannot write " + path.string() + ": " + header.message};
  }
  return {};
}

}  // namespace fairway
