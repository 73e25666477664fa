// The figures of the documentation.

#include "tests/figures/pages.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "tests/figures/choices.h"
#include "tests/figures/colour_map.h"
#include "tests/figures/experiments.h"
#include "tests/figures/palette.h"

namespace fairway {
namespace {

namespace fs = std::filesystem;

constexpr int kPanelWidth = 336;
constexpr int kPanelHeight = 320;
constexpr std::size_t kColours = 48;
constexpr int kScaleWidth = 128;
constexpr int kScaleHeight = 12;

std::string begin_mark(const std::string& name) {
  return "<!-- figure " + name + " -->\n";
}
constexpr std::string_view kEndMark = "<!-- end -->";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string picture_name(const Figure& figure, std::size_t panel) {
  return fmt::format("{}-{}.png", figure.name, static_cast<char>('a' + static_cast<int>(panel)));
}

/// With its letter where the caption names panels so; parameters look as they are typed.
std::string title_of(const Figure& figure, std::size_t panel) {
  const std::string title = escaped(figure.panels[panel].title);
  if (title.starts_with('{')) return "<code>" + title + "</code>";
  const bool named = figure.caption.find("(c)") != std::string::npos;
  return named ? fmt::format("({}) {}", static_cast<char>('a' + static_cast<int>(panel)), title)
               : title;
}

/// What was measured, a line for each number, and the scale where it is another than the first's.
std::string note_of(const Figure& figure, std::size_t panel) {
  std::string note = escaped(figure.panels[panel].note);
  const Scale& scale = figure.panels[panel].scale;
  if (scale != figure.panels.front().scale) {
    note += fmt::format(", colour: {} to {:.3g}", escaped(scale.title), scale.most);
  }
  for (std::size_t at = 0; (at = note.find(", ", at)) != std::string::npos;) {
    note.replace(at, 2, "<br>");
  }
  return note;
}

std::string scale_html(const Scale& scale) {
  return fmt::format(
      "<p class=\"scale\">{}: 0 <img src=\"/docs/scale.png\" width=\"{}\" height=\"{}\" alt=\"from "
      "light grey by orange to black\"> {:.3g}</p>\n",
      escaped(scale.title), kScaleWidth, kScaleHeight, scale.most);
}

Result<std::string> read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) return Error{ErrorCode::io, "Cannot read " + path.string()};
  return text;
}

Result<void> write_text(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) return Error{ErrorCode::io, "Cannot write " + path.string()};
  return {};
}

/// The pages of the folder by their paths.
Result<std::map<fs::path, std::string>> pages_in(const fs::path& folder) {
  std::map<fs::path, std::string> pages;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    if (entry.path().extension() != ".html") continue;
    Result<std::string> text = read_text(entry.path());
    if (!text) return text.error();
    pages.emplace(entry.path(), *std::move(text));
  }
  if (failed) return Error{ErrorCode::io, "Cannot read the folder " + folder.string()};
  return pages;
}

Result<void> write_pictures(Figure& figure, const fs::path& folder) {
  figure.panel_width = kPanelWidth;
  figure.panel_height = kPanelHeight;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const fs::path path = folder / picture_name(figure, i);
    const PaletteImage image = with_palette(picture(figure, figure.panels[i]), kColours);
    if (auto done = write_png(image, path); !done) return done;
    fmt::print("{}: {} bytes; {}, {}\n", path.string(), fs::file_size(path), figure.panels[i].title,
               figure.panels[i].note);
  }
  return {};
}

Result<void> write_scale(const fs::path& folder) {
  Image image(kScaleWidth, kScaleHeight);
  for (int y = 0; y < kScaleHeight; ++y) {
    for (int x = 0; x < kScaleWidth; ++x) {
      image.at(x, y) = colour_of(static_cast<double>(x) / (kScaleWidth - 1));
    }
  }
  return write_png(with_palette(image, kScaleWidth), folder / "scale.png");
}

/// Draws the experiment if a page has a place for it, and puts it there.
Result<void> place(const Experiment& experiment, const fs::path& folder,
                   std::map<fs::path, std::string>& pages) {
  const std::string name(experiment.name);
  std::optional<std::string> shown;
  for (auto& [path, text] : pages) {
    if (text.find(begin_mark(name)) == std::string::npos) continue;
    if (!shown) {
      Result<Figure> figure = experiment.run();
      if (!figure) return figure.error();
      if (auto done = write_pictures(*figure, folder); !done) return done;
      shown = html(*figure);
    }
    Result<std::string> changed = with_figure(text, name, *shown);
    if (!changed) return changed.error();
    text = *std::move(changed);
  }
  return {};
}

}  // namespace

std::string html(const Figure& figure) {
  std::string out = "<figure>\n<div class=\"panels\">\n";
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    out += fmt::format(
        "<figure><img src=\"/docs/{}\" width=\"{}\" height=\"{}\" loading=\"lazy\" alt=\"The mesh: "
        "{}\"><figcaption>{}<br>{}</figcaption></figure>\n",
        picture_name(figure, i), kPanelWidth, kPanelHeight, escaped(figure.panels[i].title),
        title_of(figure, i), note_of(figure, i));
  }
  out += "</div>\n" + scale_html(figure.panels.front().scale);
  return out + "<figcaption>" + escaped(figure.caption) + "</figcaption>\n</figure>\n";
}

Result<std::string> with_figure(std::string page, const std::string& name,
                                const std::string& html) {
  const std::string begin = begin_mark(name);
  const std::size_t at = page.find(begin);
  if (at == std::string::npos) return page;
  const std::size_t from = at + begin.size();
  const std::size_t end = page.find(kEndMark, from);
  if (end == std::string::npos) {
    return Error{ErrorCode::malformed_input,
                 fmt::format("The place for {} has no {}.", name, kEndMark)};
  }
  return page.replace(from, end - from, html);
}

Result<void> write_documentation(const fs::path& folder) {
  Result<std::map<fs::path, std::string>> pages = pages_in(folder);
  if (!pages) return pages.error();
  if (auto done = write_scale(folder); !done) return done;
  for (const std::span<const Experiment> list : {experiments(), choices()}) {
    for (const Experiment& experiment : list) {
      if (auto done = place(experiment, folder, *pages); !done) return done;
    }
  }
  for (const auto& [path, text] : *pages) {
    if (auto done = write_text(path, text); !done) return done;
  }
  return {};
}

}  // namespace fairway
