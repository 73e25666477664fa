// Pictures of few colours.

#include "tests/figures/palette.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include <png.h>

namespace fairway {
namespace {

using Colour = std::array<std::uint8_t, 3>;

/// A colour of the picture and how many pixels have it.
struct Entry {
  Colour colour;
  std::size_t count;
};

/// A range of the entries.
struct Box {
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t longest = 0;  // channel
  double gain = 0.0;        // square of that side times the pixels

  Box(const std::vector<Entry>& entries, std::size_t from, std::size_t to) : first(from), last(to) {
    Colour low = entries[first].colour;
    Colour high = low;
    std::size_t pixels = 0;
    for (std::size_t i = first; i < last; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        low[c] = std::min(low[c], entries[i].colour[c]);
        high[c] = std::max(high[c], entries[i].colour[c]);
      }
      pixels += entries[i].count;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      if (high[c] - low[c] > high[longest] - low[longest]) longest = c;
    }
    const double side = high[longest] - low[longest];
    gain = side * side * static_cast<double>(pixels);
  }
};

/// Where the box's pixels are halved; leaves entries on both sides.
std::size_t median_of(std::vector<Entry>& entries, const Box& box) {
  const auto begin = entries.begin() + static_cast<std::ptrdiff_t>(box.first);
  const auto end = entries.begin() + static_cast<std::ptrdiff_t>(box.last);
  std::sort(begin, end, [&](const Entry& a, const Entry& b) {
    return a.colour[box.longest] != b.colour[box.longest]
               ? a.colour[box.longest] < b.colour[box.longest]
               : a.colour < b.colour;
  });
  const std::size_t all = std::accumulate(
      begin, end, std::size_t{0}, [](std::size_t n, const Entry& e) { return n + e.count; });
  std::size_t before = 0;
  std::size_t middle = box.first;
  while (middle < box.last && 2 * before < all) before += entries[middle++].count;
  return std::clamp(middle, box.first + 1, box.last - 1);
}

Rgb mean_of(const std::vector<Entry>& entries, const Box& box) {
  std::array<std::size_t, 3> sum{};
  std::size_t pixels = 0;
  for (std::size_t i = box.first; i < box.last; ++i) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += entries[i].count * entries[i].colour[c];
    pixels += entries[i].count;
  }
  const auto channel = [&](std::size_t c) {
    return static_cast<std::uint8_t>((sum[c] + pixels / 2) / pixels);
  };
  return {channel(0), channel(1), channel(2)};
}

std::vector<Box> boxes_of(std::vector<Entry>& entries, std::size_t most) {
  std::vector<Box> boxes = {Box(entries, 0, entries.size())};
  while (boxes.size() < most) {
    const auto best = std::ranges::max_element(boxes, {}, &Box::gain);
    if (best->gain <= 0.0) break;
    const Box whole = *best;
    const std::size_t middle = median_of(entries, whole);
    *best = Box(entries, whole.first, middle);
    boxes.emplace_back(entries, middle, whole.last);
  }
  return boxes;
}

Colour key_of(const Rgb& pixel) {
  return {pixel.r, pixel.g, pixel.b};
}

}  // namespace

PaletteImage with_palette(const Image& image, std::size_t most) {
  std::map<Colour, std::size_t> counts;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) ++counts[key_of(image.at(x, y))];
  }
  std::vector<Entry> entries;
  entries.reserve(counts.size());
  for (const auto& [colour, count] : counts) entries.push_back({colour, count});
  PaletteImage out{image.width(), image.height(), {}, {}};
  std::map<Colour, std::uint8_t> place_of;
  for (const Box& box : boxes_of(entries, most)) {
    for (std::size_t i = box.first; i < box.last; ++i) {
      place_of[entries[i].colour] = static_cast<std::uint8_t>(out.colours.size());
    }
    out.colours.push_back(mean_of(entries, box));
  }
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      out.places.push_back(place_of[key_of(image.at(x, y))]);
    }
  }
  return out;
}

Result<void> write_png(const PaletteImage& image, const std::filesystem::path& path) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB_COLORMAP;
  header.colormap_entries = static_cast<png_uint_32>(image.colours.size());
  std::vector<std::uint8_t> colours;
  for (const Rgb& one : image.colours) colours.insert(colours.end(), {one.r, one.g, one.b});
  if (png_image_write_to_file(&header, path.c_str(), 0, image.places.data(), 0, colours.data()) ==
      0) {
    return Error{ErrorCode::io, "Cannot write " + path.string() + ": " + header.message};
  }
  return {};
}

}  // namespace fairway
