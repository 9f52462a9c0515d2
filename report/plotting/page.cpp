#include "report/plotting/page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/assert.hpp"
#include "core/embedded_file.hpp"
#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::embedded {
std::span<const EmbeddedFile> plotting_files();
}  // namespace hybridtest::embedded

namespace hybridtest::plot {
namespace {

std::string_view file_of_page(std::string_view name) {
  const auto files = embedded::plotting_files();
  const auto found = std::ranges::find(files, name, &EmbeddedFile::name);
  HYBRIDTEST_ASSERT(found != files.end());
  return found->content;
}

std::string table_row(const std::vector<std::string>& cells, std::string_view tag) {
  std::string row = "<tr>";
  for (const std::string& cell : cells) row += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
  return row + "</tr>\n";
}

std::string table_of(std::string_view opening, const std::vector<std::string>& head,
                     const std::vector<std::vector<std::string>>& rows) {
  std::string table = fmt::format("{}\n{}", opening, table_row(head, "th"));
  for (const std::vector<std::string>& row : rows) table += table_row(row, "td");
  return table + "</table>\n";
}

}  // namespace

std::string page_head(std::string_view title, std::string_view style) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n"
      "<style>\n{}{}</style>\n</head>\n<body>\n",
      escaped(title), file_of_page("page.css"), style);
}

std::string page_end() { return fmt::format("<script>\n{}</script>\n</body>\n</html>\n", file_of_page("figures.js")); }

std::string scrolling(const std::string& html) { return "<div class=\"scroll\" tabindex=\"0\">\n" + html + "</div>\n"; }

std::string html_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  return table_of("<table>", head, rows);
}

std::string number_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  return table_of("<table class=\"figures\">", head, rows);
}

std::string html_page(const std::string& title, const std::string& lead, const std::vector<PageSection>& sections) {
  std::string page = page_head(title) + fmt::format("<h1>{}</h1>\n<p>{}</p>\n", escaped(title), escaped(lead));
  for (const PageSection& section : sections) {
    page += fmt::format("<h2>{}</h2>\n<p>{}</p>\n{}", escaped(section.heading), escaped(section.text),
                        scrolling(section.html));
  }
  return page + page_end();
}

}  // namespace hybridtest::plot
