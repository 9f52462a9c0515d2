#include "report/plotting/dot_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "report/plotting/colours.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::plot {
namespace {

constexpr double kLetter = 7.2;  // [px] width
constexpr double kRow = 19.0;
constexpr double kDotTop = 48.0;
constexpr double kDotBottom = 42.0;

Scale scale_of(const DotFigure& figure) {
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const DotRow& row : figure.rows) {
    for (const double value : row.values) {
      if (!std::isfinite(value) || (figure.axis.is_logarithmic && value <= 0.0)) continue;
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  return {figure.axis, least, most};
}

double widest(const DotFigure& figure, std::string DotRow::*text) {
  std::size_t letters = 0;
  for (const DotRow& row : figure.rows) letters = std::max(letters, (row.*text).size());
  return 14.0 + kLetter * static_cast<double>(letters);
}

}  // namespace

std::string to_svg(const DotFigure& figure) {
  const double left = widest(figure, &DotRow::label);
  const Box box{left, kDotTop, figure.width - left - widest(figure, &DotRow::note) - 6.0,
                kRow * static_cast<double>(figure.rows.size())};
  const Scale scale = scale_of(figure);
  SvgCanvas canvas{figure.width, box.bottom() + kDotBottom, figure.title};
  canvas.text({8.0, 16.0}, figure.title, Anchor::start, 13.0, true);
  double legend_x = 8.0;
  for (std::size_t mark = 0; mark < figure.marks.size(); ++mark) {
    canvas.dot({legend_x + 5.0, 32.0}, 4.5, kOtherColours[mark % kOtherColours.size()]);
    canvas.text({legend_x + 14.0, 36.0}, figure.marks[mark], Anchor::start);
    legend_x += 34.0 + kLetter * static_cast<double>(figure.marks[mark].size());
  }
  for (const Tick& tick : scale.ticks()) {
    const double x = box.left + scale.share(tick.value) * box.width;
    canvas.line({x, box.top}, {x, box.bottom()}, {"#e4e4e4", 1.0, ""});
    canvas.text({x, box.bottom() + 15.0}, tick.label, Anchor::middle, 11.0);
  }
  for (std::size_t i = 0; i < figure.rows.size(); ++i) {
    const DotRow& row = figure.rows[i];
    const double y = box.top + (static_cast<double>(i) + 0.5) * kRow;
    if (row.is_emphasised) canvas.bar({box.left, y - kRow / 2.0, box.width, kRow}, "#fff3c4");
    canvas.line({box.left, y}, {box.right(), y}, {"#eeeeee", 1.0, ""});
    canvas.text({box.left - 7.0, y + 4.0}, row.label, Anchor::end, 12.0, row.is_emphasised);
    canvas.text({box.right() + 7.0, y + 4.0}, row.note, Anchor::start, 11.0);
    for (std::size_t mark = row.values.size(); mark-- > 0;) {
      const double share = scale.share(row.values[mark]);
      if (!std::isfinite(share)) continue;
      const bool is_outside = share < 0.0 || share > 1.0;
      canvas.dot({box.left + std::clamp(share, 0.0, 1.0) * box.width, y}, 4.5,
                 is_outside ? "#ffffff" : kOtherColours[mark % kOtherColours.size()],
                 kOtherColours[mark % kOtherColours.size()]);
    }
  }
  canvas.frame(box);
  canvas.text({box.left + box.width / 2.0, box.bottom() + 33.0}, figure.axis.label, Anchor::middle);
  return canvas.svg();
}

}  // namespace hybridtest::plot
