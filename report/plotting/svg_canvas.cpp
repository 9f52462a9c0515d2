#include "report/plotting/svg_canvas.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hybridtest::plot {
namespace {

std::string attributes(const Stroke& stroke) {
  std::string text = fmt::format(R"(stroke="{}" stroke-width="{:g}")", stroke.colour, stroke.width);
  if (!stroke.dashes.empty()) text += fmt::format(R"( stroke-dasharray="{}")", stroke.dashes);
  return text;
}

}  // namespace

SvgCanvas::SvgCanvas(double width, double height)
    : head_{fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {0:g} {1:g}" width="{0:g}" )"
                        R"(height="{1:g}" style="min-width:{0:g}px" font-family="DejaVu Sans, Verdana, sans-serif">)"
                        "\n"
                        R"(<rect width="{0:g}" height="{1:g}" fill="#fff"/>)"
                        "\n",
                        width, height)} {}

void SvgCanvas::line(Place from, Place to, const Stroke& stroke) {
  body_ += fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" {}/>)"
                       "\n",
                       from.x, from.y, to.x, to.y, attributes(stroke));
}

void SvgCanvas::curve(std::span<const Place> places, const Stroke& stroke, const Box& clip) {
  if (places.size() < 2) return;
  // The id follows from the box, so that equal ids on one page mean equal boxes.
  const std::string id = fmt::format("clip_{:.0f}_{:.0f}_{:.0f}_{:.0f}", clip.left, clip.top, clip.width, clip.height);
  if (body_.find("id=\"" + id + "\"") == std::string::npos) {
    body_ += fmt::format(R"(<clipPath id="{}"><rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}"/></clipPath>)"
                         "\n",
                         id, clip.left, clip.top, clip.width, clip.height);
  }
  body_ += fmt::format(R"-(<polyline clip-path="url(#{})" fill="none" stroke-linejoin="round" {} points=")-", id,
                       attributes(stroke));
  for (const Place& place : places) {
    body_ += fmt::format("{:.1f},{:.1f} ", std::clamp(place.x, clip.left - clip.width, clip.right() + clip.width),
                         std::clamp(place.y, clip.top - clip.height, clip.bottom() + clip.height));
  }
  body_.back() = '"';
  body_ += "/>\n";
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
