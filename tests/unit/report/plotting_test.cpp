#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>

#include "report/plotting/axis.hpp"
#include "report/plotting/dot_figure.hpp"
#include "report/plotting/line_figure.hpp"
#include "report/plotting/page.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::plot {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Scale, MapsEndsToZeroAndOne) {
  const Scale linear{{.label = "", .is_logarithmic = false, .low = 2.0, .high = 6.0}, 0.0, 1.0};
  EXPECT_DOUBLE_EQ(linear.share(2.0), 0.0);
  EXPECT_DOUBLE_EQ(linear.share(5.0), 0.75);
  const Scale logarithmic{{.label = "", .is_logarithmic = true, .low = 0.1, .high = 10.0}, 0.0, 1.0};
  EXPECT_NEAR(logarithmic.share(1.0), 0.5, 1e-15);
  EXPECT_FALSE(std::isfinite(logarithmic.share(0.0)));
}

TEST(Scale, TicksAreRoundAndInRange) {
  const Scale scale{{.label = "", .is_logarithmic = false, .low = -0.7, .high = 3.3}, 0.0, 1.0};
  std::vector<std::string> labels;
  for (const Tick& tick : scale.ticks()) {
    EXPECT_GE(scale.share(tick.value), -1e-12);
    EXPECT_LE(scale.share(tick.value), 1.0 + 1e-12);
    labels.push_back(tick.label);
  }
  EXPECT_THAT(labels, testing::ElementsAre("-0.5", "0", "0.5", "1", "1.5", "2", "2.5", "3"));
}

TEST(Scale, AcceptsConstantAndEmptyValues) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isfinite(Scale(Axis{}, 3.0, 3.0).share(3.0)));
  EXPECT_TRUE(std::isfinite(Scale(Axis{}, kInfinity, -kInfinity).share(0.0)));
}

TEST(LineFigure, NonFiniteValuesLeaveAGap) {
  const Line line{.name = "broken", .x = {0, 1, 2, 3, 4}, .y = {0, 1, std::nan(""), 1, 0}};
  const std::string svg = to_svg(LineFigure{.panels = {{.title = "", .x = {}, .y = {}, .lines = {line}}}});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  std::size_t pieces = 0;
  for (auto at = svg.find("<polyline"); at != std::string::npos; at = svg.find("<polyline", at + 1)) ++pieces;
  EXPECT_EQ(pieces, 2U);
}

TEST(LineFigure, ThinningKeepsExtremes) {
  Line line{.name = "spike", .x = {}, .y = {}};
  for (int i = 0; i < 100000; ++i) {
    line.x.push_back(i);
    line.y.push_back(i == 51234 ? 1.0 : 0.0);
  }
  const std::string svg =
      to_svg(LineFigure{.panels = {{.title = "",
                                    .x = {},
                                    .y = {.label = "", .is_logarithmic = false, .low = 0.0, .high = 1.0},
                                    .lines = {line}}}});
  EXPECT_LT(svg.size(), 60000U);
  // The top of the panel's frame.
  EXPECT_THAT(svg, HasSubstr(",26.0 "));
}

TEST(DotFigure, ClampsValuesToTheAxis) {
  const DotFigure figure{.title = "t",
                         .axis = {.label = "a", .is_logarithmic = true, .low = 1.0, .high = 10.0},
                         .marks = {"m"},
                         .rows = {{"far", {1e6}, "", false}, {"none", {std::nan("")}, "lost", false}}};
  const std::string svg = to_svg(figure);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, HasSubstr("lost"));
}

TEST(Page, IsSelfContainedAndEscapesText) {
  const std::string page = html_page("a < b & c", "lead", {{"h", "t", to_svg(LineFigure{})}});
  EXPECT_THAT(page, HasSubstr("a &lt; b &amp; c"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("src=")));
  EXPECT_THAT(page, Not(HasSubstr("href=")));
}

/// On a telephone a figure scrolls in its own box at its natural size: all its labels have at least 10 px.
TEST(Page, FiguresAreNotMadeSmallerThanTheirLabelsAllow) {
  const LineFigure figure{.panels = {{.title = "t", .x = {"x"}, .y = {"y"}, .lines = {{"a", {0, 1}, {0, 1}}}}},
                          .columns = 1,
                          .panel_width = 900.0};
  const std::string page = html_page("title", "lead", {{"h", "t", to_svg(figure)}});
  EXPECT_THAT(page, HasSubstr("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"));
  EXPECT_THAT(page, HasSubstr("<div class=\"scroll\">\n<svg"));
  EXPECT_THAT(page, HasSubstr("style=\"min-width:900px\""));
  EXPECT_THAT(page, HasSubstr(".scroll { overflow-x: auto;"));
  const std::regex size{"font-size=\"([0-9.]+)\""};
  int labels = 0;
  for (std::sregex_iterator at{page.begin(), page.end(), size}, end; at != end; ++at, ++labels) {
    EXPECT_GE(std::stod((*at)[1]), 10.0);
  }
  EXPECT_GT(labels, 5);
}

TEST(Page, TableHasItsRowsInOrder) {
  EXPECT_EQ(html_table({"method", "error"}, {{"<a>", "1"}, {"b", "2"}}),
            "<table>\n<tr><th>method</th><th>error</th></tr>\n<tr><td>&lt;a&gt;</td><td>1</td></tr>\n"
            "<tr><td>b</td><td>2</td></tr>\n</table>\n");
}

}  // namespace
}  // namespace hybridtest::plot
