#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hybridtest::plot {

/// The beginning of a page up to `<body>`. The page needs no network: style, figures and script are inline.
/// @param style   of this page alone, after the style of all pages (page.css).
[[nodiscard]] std::string page_head(std::string_view title, std::string_view style = {});

/// The end of a page, with the script of its figures (figures.js).
[[nodiscard]] std::string page_end();

/// A figure or table in a box of its own that scrolls sideways where the screen is narrower.
[[nodiscard]] std::string scrolling(const std::string& html);

/// A table with a head. All texts are plain; cells are aligned to the left.
/// @param rows   of as many cells as the head has.
[[nodiscard]] std::string html_table(const std::vector<std::string>& head,
                                     const std::vector<std::vector<std::string>>& rows);
/// The same for numbers: cells are aligned to the right from the second column on.
[[nodiscard]] std::string number_table(const std::vector<std::string>& head,
                                       const std::vector<std::vector<std::string>>& rows);

/// One part of a page with its explanation.
struct PageSection {
  std::string heading;
  std::string text;  // plain
  std::string html;  // figures and tables
};

/// A page of sections.
[[nodiscard]] std::string html_page(const std::string& title, const std::string& lead,
                                    const std::vector<PageSection>& sections);

}  // namespace hybridtest::plot
