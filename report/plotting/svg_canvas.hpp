#pragma once

#include <span>
#include <string>
#include <string_view>

namespace hybridtest::plot {

/// A place on the canvas [px], from the upper left corner.
struct Place {
  double x = 0.0;
  double y = 0.0;
};

enum class Anchor { start, middle, end };

struct Stroke {
  std::string_view colour = "#444";
  double width = 1.0;
  std::string_view dashes;  // as SVG's stroke-dasharray; empty: solid
};

struct Box {
  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;
  [[nodiscard]] double right() const noexcept { return left + width; }
  [[nodiscard]] double bottom() const noexcept { return top + height; }
};

/// A self-contained SVG drawing: no style sheet, no script, white background. A page may enlarge it, but not shrink it:
/// its labels would become too small to read.
class SvgCanvas {
 public:
  /// @param title   read out by a screen reader; may be empty.
  SvgCanvas(double width, double height, std::string_view title);

  void line(Place from, Place to, const Stroke& stroke);
  /// What is drawn until end_panel() belongs together; `attributes` tell figures.js what it shows.
  void begin_panel(std::string_view attributes);
  void end_panel();
  /// A window onto the curves until end_window(); outside of it they are cut off. Zooming moves the window.
  void begin_window(const Box& box);
  void end_window();
  /// A curve in a window. A place that is not finite is a gap; places far outside the box are moved nearer to it.
  void curve(std::span<const Place> places, const Stroke& stroke, const Box& box, std::string_view name);
  /// A vertical line in a window, which says what happened there.
  void mark(double x, const Box& box, std::string_view text, std::string_view colour);
  void dot(Place at, double radius, std::string_view colour, std::string_view outline = "none");
  void frame(const Box& box);
  void bar(const Box& box, std::string_view colour);
  void text(Place at, std::string_view text, Anchor anchor, double size = 12.0, bool is_bold = false);
  /// Grid lines and labels of an axis until end_axes(): figures.js draws them anew where a panel is zoomed.
  void begin_axes();
  void end_axes();
  /// Rotated text, read upwards.
  void vertical_text(Place at, std::string_view text, double size = 12.0);

  [[nodiscard]] std::string svg() const;

 private:
  std::string body_;
  std::string head_;
};

/// With the special characters of HTML and SVG replaced.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace hybridtest::plot
