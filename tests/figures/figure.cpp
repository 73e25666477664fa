// Panels, labels and legends put together.

#include "tests/figures/figure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "tests/figures/colour_map.h"

namespace fairway {
namespace {

constexpr int kSamples = 3;
constexpr int kMargin = 8;
constexpr int kLegendWidth = 90;
constexpr double kRoom = 1.06;
constexpr double kLineWidth = 1.6;

void draw_centred(Image& image, int middle, int y, const std::string& text, int scale) {
  draw_text(image, middle - text_width(text, scale) / 2, y, text, scale);
}

void draw_legend(Image& image, int x, const Scale& scale, int height) {
  constexpr int kBarWidth = 18;
  const int top = 36;
  const int bottom = height - 30;
  for (int y = top; y < bottom; ++y) {
    const double value = static_cast<double>(bottom - 1 - y) / (bottom - 1 - top);
    for (int i = 0; i < kBarWidth; ++i) image.at(x + i, y) = colour_of(value);
  }
  draw_text(image, x, 8, scale.title, 2);
  for (int k = 0; k <= 4; ++k) {
    const int y = bottom - 1 - (bottom - 1 - top) * k / 4;
    const std::string number = fmt::format("{:.3g}", scale.most * k / 4.0);
    draw_text(image, x + kBarWidth + 5, y - 6, number, 2);
  }
}

/// True where a legend follows panel i.
bool legend_after(const Figure& figure, std::size_t i) {
  if (figure.bare) return false;
  return i + 1 == figure.panels.size() || figure.panels[i].scale != figure.panels[i + 1].scale;
}

/// "(a) noisy"
std::string lettered(const Figure& figure, std::size_t i) {
  return fmt::format("({}) {}", static_cast<char>('a' + static_cast<int>(i)),
                     figure.panels[i].title);
}

/// Text for a cell of a table.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

/// Every channel rounded to 32 levels.
void reduce_colours(Image& image) {
  const auto round = [](std::uint8_t& c) { c = static_cast<std::uint8_t>((c + 4) / 8 * 255 / 32); };
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      Rgb& pixel = image.at(x, y);
      round(pixel.r);
      round(pixel.g);
      round(pixel.b);
    }
  }
}

}  // namespace

Camera camera_for(const IndexedMesh& mesh, const Vec3& direction, const Vec3& up,
                  double width_by_height) {
  const Vec3 right = direction.cross(up).normalized();
  const Vec3 upward = right.cross(direction).normalized();
  Eigen::AlignedBox2d box;
  for (const Vec3& p : mesh.positions) box.extend(Eigen::Vector2d(p.dot(right), p.dot(upward)));
  Camera camera;
  camera.target = right * box.center().x() + upward * box.center().y();
  camera.direction = direction;
  camera.up = up;
  camera.half_height = 0.5 * kRoom * std::max(box.sizes().y(), box.sizes().x() / width_by_height);
  return camera;
}

Image picture(const Figure& figure, const Panel& panel) {
  Rasteriser rasteriser(figure.panel_width, figure.panel_height, kSamples, figure.camera);
  std::vector<Rgb> colours;
  colours.reserve(panel.values.size());
  for (const double value : panel.values) colours.push_back(colour_of(value / panel.scale.most));
  rasteriser.draw(panel.mesh, colours, Shading::flat);
  rasteriser.draw_line(panel.line, kLineWidth, {0, 0, 0});
  return rasteriser.image();
}

Image compose(const Figure& figure) {
  const int line_height = 11 * figure.text_scale;
  int width = kMargin;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    width += figure.panel_width + kMargin + (legend_after(figure, i) ? kLegendWidth : 0);
  }
  const int lines = figure.bare ? 1 : 2;
  Image image(width, figure.panel_height + lines * line_height + 2 * kMargin);
  int x = kMargin;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const Panel& panel = figure.panels[i];
    image.paste(picture(figure, panel), x, kMargin);
    const int middle = x + figure.panel_width / 2;
    const int below = figure.panel_height + kMargin;
    draw_centred(image, middle, below, figure.bare ? panel.title : lettered(figure, i),
                 figure.text_scale);
    if (!figure.bare) {
      draw_centred(image, middle, below + line_height, panel.note, figure.text_scale);
    }
    x += figure.panel_width + kMargin;
    if (!legend_after(figure, i)) continue;
    draw_legend(image, x, panel.scale, figure.panel_height);
    x += kLegendWidth;
  }
  if (figure.bare) reduce_colours(image);
  return image;
}

std::string markdown(const Figure& figure) {
  std::string out = fmt::format(
      "## {0}\n![{0}]({0}.png)\n\n{1}\n\n| panel | measured | colours |\n|---|---|---|\n",
      figure.name, figure.caption);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const Panel& panel = figure.panels[i];
    out += fmt::format("| {} | {} | {} from 0 to {} |\n", lettered(figure, i), cell(panel.note),
                       cell(panel.scale.title), panel.scale.most);
  }
  return out + "\n";
}

}  // namespace fairway
