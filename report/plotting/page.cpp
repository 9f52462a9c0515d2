#include "report/plotting/page.hpp"

#include <fmt/format.h>

#include "report/plotting/svg_canvas.hpp"

namespace hybridtest::plot {

std::string html_page(const std::string& title, const std::string& lead, const std::vector<PageSection>& sections) {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{0}</title>\n<style>\n"
      "body {{ font: 15px/1.45 'DejaVu Sans', Verdana, sans-serif; color: #222; max-width: 1280px; margin: 24px auto; "
      "padding: 0 16px; }}\nh1 {{ font-size: 22px; }} h2 {{ font-size: 17px; margin-top: 30px; }}\n"
      "svg {{ max-width: 100%; height: auto; }}\n</style>\n</head>\n<body>\n<h1>{0}</h1>\n<p>{1}</p>\n",
      escaped(title), escaped(lead));
  for (const PageSection& section : sections) {
    page += fmt::format("<h2>{}</h2>\n<p>{}</p>\n{}", escaped(section.heading), escaped(section.text), section.svg);
  }
  return page + "</body>\n</html>\n";
}

}  // namespace hybridtest::plot
