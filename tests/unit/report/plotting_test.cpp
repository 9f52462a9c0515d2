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
#include "report/plotting/thinning.hpp"
#include "tests/support/figure_values.hpp"

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

LineFigure figure_of(std::vector<Line> lines) {
  return {.panels = {{.title = "t", .x = {.label = "x"}, .y = {.label = "y"}, .lines = std::move(lines)}}};
}

TEST(LineFigure, SaysWhereEachValueStands) {
  Line line{.name = "sine", .x = {}, .y = {}};
  for (int i = 0; i <= 1000; ++i) {
    line.x.push_back(0.01 * i);
    line.y.push_back(3.0 * std::sin(0.01 * i));
  }
  const Points read = shown_curve(to_svg(figure_of({line})), "t", "sine");
  ASSERT_GT(read.x.size(), 900U);
  double farthest = 0.0;
  for (std::size_t i = 0; i < read.x.size(); ++i) {
    farthest = std::max(farthest, std::abs(read.y[i] - 3.0 * std::sin(read.x[i])));
  }
  EXPECT_LT(farthest, 1e-3);  // a hundredth of a pixel
  EXPECT_NEAR(*std::ranges::max_element(read.y), 3.0, 3e-4);
}

TEST(LineFigure, NonFiniteValuesLeaveAGap) {
  const Line line{.name = "broken", .x = {0, 1, 2, 3, 4}, .y = {0, 1, std::nan(""), 1, 0}};
  const std::string svg = to_svg(figure_of({line}));
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  const std::string path = svg.substr(svg.find("data-name=\"broken\""));
  EXPECT_EQ(std::ranges::count(path.substr(0, path.find("/>")), 'M'), 2);
}

TEST(LineFigure, ThinningKeepsExtremes) {
  Line line{.name = "spike", .x = {}, .y = {}};
  for (int i = 0; i < 100000; ++i) {
    line.x.push_back(i);
    line.y.push_back(i == 51234 ? 1.0 : 0.0);
  }
  const std::string svg = to_svg(figure_of({line}));
  EXPECT_LT(svg.size(), 60000U);
  const Points read = shown_curve(svg, "t", "spike");
  const auto highest = std::ranges::max_element(read.y);
  EXPECT_NEAR(*highest, 1.0, 1e-4);
  EXPECT_NEAR(read.x[static_cast<std::size_t>(highest - read.y.begin())], 51234.0, 2.0);
}

TEST(LineFigure, ASignalHasTheSameColourEverywhere) {
  const std::string alone =
      to_svg(figure_of({{.name = "measured", .x = {0, 1}, .y = {0, 1}, .signal = Signal::measured}}));
  EXPECT_THAT(alone, HasSubstr("stroke=\"#d55e00\""));
  const std::string beside =
      to_svg(figure_of({{.name = "a", .x = {0, 1}, .y = {0, 1}},
                        {.name = "b", .x = {0, 1}, .y = {0, 1}},
                        {.name = "measured", .x = {0, 1}, .y = {0, 1}, .signal = Signal::measured}}));
  const std::size_t at = beside.find("data-name=\"measured\"");
  EXPECT_THAT(beside.substr(at, 160), HasSubstr("stroke=\"#d55e00\""));
  EXPECT_THAT(beside.substr(beside.find("data-name=\"a\""), 160), Not(HasSubstr("#d55e00")));
}

TEST(LineFigure, MarksSayWhatHappened) {
  LineFigure figure = figure_of({{.name = "a", .x = {0, 10}, .y = {0, 1}}});
  figure.panels[0].marks = {{.x = 5.0, .text = "displacement limit < exceeded", .is_fault = true},
                            {.x = 99.0, .text = "far"}};
  const std::string svg = to_svg(figure);
  EXPECT_THAT(svg, HasSubstr("<title>displacement limit &lt; exceeded</title>"));
  EXPECT_THAT(svg, Not(HasSubstr("far")));
}

TEST(HistoryThinner, MemoryDoesNotGrowWithTheHistory) {
  HistoryThinner thinner{0.0, 1e6, 100};
  for (int i = 0; i < 1'000'000; ++i) thinner.add(i, i % 1000 == 0 ? 7.0 : -i % 3);
  const Points points = thinner.take();
  EXPECT_LE(points.x.size(), 202U);
  EXPECT_EQ(*std::ranges::max_element(points.y), 7.0);
  EXPECT_EQ(*std::ranges::min_element(points.y), -2.0);
  EXPECT_TRUE(std::ranges::is_sorted(points.x));
  EXPECT_EQ(points.x.back(), 999'999.0);
}

TEST(LoopThinner, KeepsTheShapeWithFewPoints) {
  LoopThinner thinner{500};
  for (int i = 0; i < 100'000; ++i) thinner.add(std::cos(1e-3 * i), std::sin(1e-3 * i));
  const Points points = thinner.take();
  EXPECT_LE(points.x.size(), 501U);
  EXPECT_GT(points.x.size(), 100U);
  EXPECT_NEAR(*std::ranges::max_element(points.x), 1.0, 0.05);
  for (std::size_t i = 0; i < points.x.size(); ++i) EXPECT_NEAR(std::hypot(points.x[i], points.y[i]), 1.0, 1e-12);
}

TEST(LoopThinner, AGapStaysAGap) {
  LoopThinner thinner{16};
  for (const double x : {0.0, 1.0, std::nan(""), std::nan(""), 2.0}) thinner.add(x, x);
  const Points points = thinner.take();
  EXPECT_EQ(std::ranges::count_if(points.x, [](double x) { return std::isnan(x); }), 1);
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
  EXPECT_THAT(page, Not(HasSubstr("<script ")));
  EXPECT_THAT(page, Not(HasSubstr(" src=")));
  EXPECT_THAT(page, Not(HasSubstr(" href=")));
}

/// On a telephone a figure scrolls in its own box at its natural size: all its labels have at least 10 px.
TEST(Page, FiguresAreNotMadeSmallerThanTheirLabelsAllow) {
  const LineFigure figure{.panels = {{.title = "t", .x = {"x"}, .y = {"y"}, .lines = {{"a", {0, 1}, {0, 1}}}}},
                          .columns = 1,
                          .panel_width = 900.0};
  const std::string page = html_page("title", "lead", {{"h", "t", to_svg(figure)}});
  EXPECT_THAT(page, HasSubstr("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"));
  EXPECT_THAT(page, HasSubstr("<div class=\"scroll\" tabindex=\"0\">\n<svg"));
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
