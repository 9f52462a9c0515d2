#pragma once

#include <string>
#include <vector>

namespace hybridtest::plot {

/// One figure of a page with its explanation.
struct PageSection {
  std::string heading;
  std::string text;  // plain
  std::string svg;
};

/// A page that needs no network: all figures are inline.
[[nodiscard]] std::string html_page(const std::string& title, const std::string& lead,
                                    const std::vector<PageSection>& sections);

}  // namespace hybridtest::plot
