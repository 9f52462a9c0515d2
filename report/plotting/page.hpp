#pragma once

#include <string>
#include <vector>

namespace hybridtest::plot {

/// One figure of a page with what it shows.
struct PageSection {
  std::string heading;
  std::string text;  // plain
  std::string svg;
};

/// A page that opens without a network: figures inline.
[[nodiscard]] std::string html_page(const std::string& title, const std::string& lead,
                                    const std::vector<PageSection>& sections);

}  // namespace hybridtest::plot
