#include "report/plotting/page.hpp"

#include <fmt/format.h>

#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::plot {
namespace {

std::string table_row(const std::vector<std::string>& cells, std::string_view tag) {
  std::string row = "<tr>";
  for (const std::string& cell : cells) row += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
  return row + "</tr>\n";
}

}  // namespace

std::string scrolling(const std::string& html) { return "<div class=\"scroll\">\n" + html + "</div>\n"; }

std::string html_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  std::string table = "<table>\n" + table_row(head, "th");
  for (const std::vector<std::string>& row : rows) table += table_row(row, "td");
  return table + "</table>\n";
}

std::string html_page(const std::string& title, const std::string& lead, const std::vector<PageSection>& sections) {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n<style>\n"
      "body {{ font: 15px/1.45 'DejaVu Sans', Verdana, sans-serif; color: #222; max-width: 1280px; margin: 24px auto; "
      "padding: 0 16px; }}\nh1 {{ font-size: 22px; }} h2 {{ font-size: 17px; margin-top: 30px; }}\n"
      "svg {{ max-width: 100%; }}\ntable {{ border-collapse: collapse; }}\n"
      "td, th {{ text-align: right; padding: 5px 0 5px 18px; font-size: 14px; border-bottom: 1px solid #d0d0d0; "
      "white-space: nowrap; }}\nth {{ color: #666; font-weight: normal; }}\n"
      "td:first-child, th:first-child {{ text-align: left; padding-left: 0; }}\n{2}</style>\n</head>\n<body>\n"
      "<h1>{0}</h1>\n<p>{1}</p>\n",
      escaped(title), escaped(lead), kScrollStyle);
  for (const PageSection& section : sections) {
    page += fmt::format("<h2>{}</h2>\n<p>{}</p>\n{}", escaped(section.heading), escaped(section.text),
                        scrolling(section.html));
  }
  return page + "</body>\n</html>\n";
}

}  // namespace hybridtest::plot
