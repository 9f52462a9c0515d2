#include "report/plotting/svg_canvas.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hybridtest::plot {
namespace {

std::string attributes(const Stroke& stroke) {
  std::string text = fmt::format(R"(stroke="{}" stroke-width="{:g}")", stroke.colour, stroke.width);
  if (!stroke.dashes.empty()) text += fmt::format(R"( stroke-dasharray="{}")", stroke.dashes);
  return text;
}

long hundredths(double pixels) noexcept { return std::lround(100.0 * pixels); }

/// As short as possible: 1.5, .25, -3.
void append_hundredths(std::string& text, long value) {
  if (value < 0) text += '-';
  const unsigned long size = value < 0 ? static_cast<unsigned long>(-value) : static_cast<unsigned long>(value);
  const unsigned long whole = size / 100;
  const unsigned long part = size % 100;
  if (whole > 0 || part == 0) text += std::to_string(whole);
  if (part == 0) return;
  text += '.';
  text += static_cast<char>('0' + part / 10);
  if (part % 10 != 0) text += static_cast<char>('0' + part % 10);
}

}  // namespace

SvgCanvas::SvgCanvas(double width, double height, std::string_view title)
    : head_{fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" class="figure" role="img" aria-label="{2}" )"
                        R"(viewBox="0 0 {0:g} {1:g}" width="{0:g}" height="{1:g}" style="min-width:{0:g}px" )"
                        R"(font-family="DejaVu Sans, Verdana, sans-serif">)"
                        "\n"
                        R"(<rect width="{0:g}" height="{1:g}" fill="#fff"/>)"
                        "\n",
                        width, height, title.empty() ? "figure" : escaped(title))} {}

void SvgCanvas::line(Place from, Place to, const Stroke& stroke) {
  body_ += fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" {}/>)"
                       "\n",
                       from.x, from.y, to.x, to.y, attributes(stroke));
}

void SvgCanvas::begin_panel(std::string_view attributes) {
  body_ += fmt::format("<g class=\"panel\" {}>\n", attributes);
}

void SvgCanvas::end_panel() { body_ += "</g>\n"; }

void SvgCanvas::begin_axes() { body_ += "<g class=\"axes\">\n"; }

void SvgCanvas::end_axes() { body_ += "</g>\n"; }

void SvgCanvas::begin_window(const Box& box) {
  body_ +=
      fmt::format(R"(<svg class="window" x="{0:g}" y="{1:g}" width="{2:g}" height="{3:g}" viewBox="0 0 {2:g} {3:g}" )"
                  R"(preserveAspectRatio="none" overflow="hidden">)"
                  "\n",
                  box.left, box.top, box.width, box.height);
}

void SvgCanvas::end_window() { body_ += "</svg>\n"; }

void SvgCanvas::curve(std::span<const Place> places, const Stroke& stroke, const Box& box, std::string_view name) {
  body_ += fmt::format(R"(<path data-name="{}" fill="none" stroke-linejoin="round" vector-effect="non-scaling-stroke" )"
                       R"({} d=")",
                       escaped(name), attributes(stroke));
  // Relative to the place before, in whole hundredths of a pixel: half the text, and no error that adds up.
  long at_x = 0;
  long at_y = 0;
  std::size_t in_piece = 0;
  for (const Place& place : places) {
    if (!std::isfinite(place.x) || !std::isfinite(place.y)) {
      in_piece = 0;
      continue;
    }
    const long x = hundredths(std::clamp(place.x - box.left, -box.width, 2.0 * box.width));
    const long y = hundredths(std::clamp(place.y - box.top, -box.height, 2.0 * box.height));
    if (in_piece == 0) {
      body_ += 'M';
      append_hundredths(body_, x);
      body_ += ' ';
      append_hundredths(body_, y);
    } else {
      body_ += in_piece == 1 ? 'l' : ' ';
      append_hundredths(body_, x - at_x);
      body_ += ' ';
      append_hundredths(body_, y - at_y);
    }
    at_x = x;
    at_y = y;
    ++in_piece;
  }
  body_ += "\"/>\n";
}

void SvgCanvas::mark(double x, const Box& box, std::string_view text, std::string_view colour) {
  body_ +=
      fmt::format(R"(<path class="mark" data-text="{0}" fill="none" vector-effect="non-scaling-stroke" stroke="{1}" )"
                  R"(stroke-dasharray="1 3" stroke-width="1.4" d="M{2:.2f} 0l0 {3:g}"><title>{0}</title></path>)"
                  "\n",
                  escaped(text), colour, x - box.left, box.height);
}

void SvgCanvas::dot(Place at, double radius, std::string_view colour, std::string_view outline) {
  body_ += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{:g}" fill="{}" stroke="{}" stroke-width="1.3"/>)"
                       "\n",
                       at.x, at.y, radius, colour, outline);
}

void SvgCanvas::frame(const Box& box) {
  body_ += fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="none" stroke="#888"/>)"
                       "\n",
                       box.left, box.top, box.width, box.height);
}

void SvgCanvas::bar(const Box& box, std::string_view colour) {
  body_ += fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"/>)"
                       "\n",
                       box.left, box.top, box.width, box.height, colour);
}

void SvgCanvas::text(Place at, std::string_view text, Anchor anchor, double size, bool is_bold) {
  const std::string_view name = anchor == Anchor::start ? "start" : anchor == Anchor::middle ? "middle" : "end";
  body_ += fmt::format(R"(<text x="{:.1f}" y="{:.1f}" font-size="{:g}" text-anchor="{}" fill="#222"{}>{}</text>)"
                       "\n",
                       at.x, at.y, size, name, is_bold ? R"( font-weight="bold")" : "", escaped(text));
}

void SvgCanvas::vertical_text(Place at, std::string_view text, double size) {
  body_ +=
      fmt::format(R"-(<text transform="translate({:.1f} {:.1f}) rotate(-90)" font-size="{:g}" text-anchor="middle" )-"
                  R"-(fill="#222">{}</text>)-"
                  "\n",
                  at.x, at.y, size, escaped(text));
}

std::string SvgCanvas::svg() const { return head_ + body_ + "</svg>\n"; }

std::string escaped(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    switch (letter) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += letter;
    }
  }
  return result;
}

}  // namespace hybridtest::plot
