// Figures in the pages of the documentation.

#include "tests/figures/pages.h"

#include <fstream>
#include <iterator>
#include <set>

#include <catch2/catch.hpp>

#include "tests/figures/choices.h"
#include "tests/figures/experiments.h"
#include "tests/places.h"

using namespace fairway;

namespace {

Figure small_figure() {
  Figure figure;
  figure.name = "some";
  figure.caption = "5 < 6 & more";
  figure.panels.resize(2);
  figure.panels[0].title = "noisy";
  figure.panels[1].title = R"({"steps": 3})";
  figure.panels[1].note = "1.20 deg";
  return figure;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

TEST_CASE("a figure becomes HTML in which no text is taken for a tag") {
  Figure figure = small_figure();
  const std::string text = html(figure);
  CHECK(text.find("5 &lt; 6 &amp; more") != std::string::npos);
  CHECK(text.find("<code>{&quot;steps&quot;: 3}</code><br>1.20 deg") != std::string::npos);
  figure.caption = "(c) is best";
  figure.panels[1].scale = {0.2, "dist/L"};
  CHECK(html(figure).find("(a) noisy<br>") != std::string::npos);
  CHECK(html(figure).find("1.20 deg<br>colour: dist/L to 0.2<") != std::string::npos);
  CHECK(text.find("src=\"/docs/some-b.png\"") != std::string::npos);
}

TEST_CASE("a figure takes the place of an older one and nothing else") {
  const std::string page = "a\n<!-- figure x -->\nold\n<!-- end -->\nb<!-- end -->";
  const auto changed = with_figure(page, "x", "new\n");
  REQUIRE(changed);
  CHECK(*changed == "a\n<!-- figure x -->\nnew\n<!-- end -->\nb<!-- end -->");
  CHECK(*with_figure(*changed, "x", "new\n") == *changed);
  CHECK(*with_figure(page, "y", "new\n") == page);
  CHECK_FALSE(with_figure("<!-- figure x -->\nold", "x", "new"));
}

TEST_CASE("every place for a figure in the documentation has a figure that can be made") {
  std::set<std::string> known;
  for (const Experiment& one : experiments()) known.emplace(one.name);
  for (const Experiment& one : choices()) known.emplace(one.name);
  const std::string mark = "<!-- figure ";
  int places = 0;
  for (const char* page : {"parameters.html", "gallery.html"}) {
    const std::string text = text_of(test::source("server/web/docs") / page);
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) {
      const std::size_t name = at + mark.size();
      CHECK(known.count(text.substr(name, text.find(' ', name) - name)) == 1);
      CHECK(text.compare(text.find('\n', at) + 1, 8, "<figure>") == 0);
      ++places;
    }
  }
  CHECK(places == 13);
}
