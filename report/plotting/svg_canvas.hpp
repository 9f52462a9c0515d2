#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace hybridtest::plot {

/// Colours that colour-blind people can distinguish (Okabe and Ito).
inline constexpr std::array<std::string_view, 7> kColours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                          "#e69f00", "#56b4e9", "#222222"};

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
  SvgCanvas(double width, double height);

  void line(Place from, Place to, const Stroke& stroke);
  /// Clipped to the box; points far outside the box are moved nearer to it.
  void curve(std::span<const Place> places, const Stroke& stroke, const Box& clip);
  void dot(Place at, double radius, std::string_view colour, std::string_view outline = "none");
  void frame(const Box& box);
  void bar(const Box& box, std::string_view colour);
  void text(Place at, std::string_view text, Anchor anchor, double size = 12.0, bool is_bold = false);
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
