#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report/plotting/line_figure.hpp"
#include "report/run_report/report_parts.hpp"

namespace hybridtest::run_report {

inline constexpr double kWideFigure = 940.0;  // [px]
inline constexpr double kHistoryHeight = 210.0;
inline constexpr double kHalfFigure = 470.0;  // two side by side

/// A unit that people read, and its factor from SI.
struct ShownUnit {
  std::string_view unit;
  double factor = 1.0;
};
/// `mm` for `m`, `kN` for `N`; others as they are.
[[nodiscard]] ShownUnit shown_unit(std::string_view si_unit) noexcept;

/// A curve in a unit that people read.
[[nodiscard]] plot::Line line_of(const SignalCurve& curve, std::string name, plot::Signal signal = plot::Signal::other);

/// Whether the points are enough for a curve.
[[nodiscard]] bool is_drawable(const plot::Points& points) noexcept;

/// A panel over model time, with marks where something happened.
[[nodiscard]] plot::Panel time_panel(const ReportFacts& facts, std::string title, std::string y_label,
                                     std::vector<plot::Line> lines);

/// The panels that have a curve; empty without any.
[[nodiscard]] std::string figure_of(std::vector<plot::Panel> panels, int columns = 1, double width = kWideFigure,
                                    double height = kHistoryHeight);

/// A heading with an anchor and what follows it; empty for an empty part.
[[nodiscard]] std::string section(std::string_view anchor, std::string_view heading, const std::string& html);

/// Text of a number: three decimals at most, `–` for none.
[[nodiscard]] std::string number_text(double value, int decimals = 3);

}  // namespace hybridtest::run_report
