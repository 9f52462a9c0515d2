#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hybridtest::plot {

/// Style of scrolling(). Below their natural width, figures are not made smaller, so that labels stay legible on a
/// telephone.
inline constexpr std::string_view kScrollStyle =
    ".scroll { overflow-x: auto; max-width: 100%; } .scroll svg { height: auto; }\n";

/// A figure or table in a box of its own that scrolls sideways where the screen is narrower.
[[nodiscard]] std::string scrolling(const std::string& html);

/// A table with a head. All texts are plain; cells are aligned to the left, but right from the second column on.
/// @param rows   of as many cells as the head has.
[[nodiscard]] std::string html_table(const std::vector<std::string>& head,
                                     const std::vector<std::vector<std::string>>& rows);

/// One part of a page with its explanation.
struct PageSection {
  std::string heading;
  std::string text;  // plain
  std::string html;  // figures and tables
};

/// A page that needs no network: all figures are inline.
[[nodiscard]] std::string html_page(const std::string& title, const std::string& lead,
                                    const std::vector<PageSection>& sections);

}  // namespace hybridtest::plot
