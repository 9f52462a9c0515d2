#pragma once

#include <string>
#include <vector>

namespace hybridtest {

/// The effect library for a terminal.
[[nodiscard]] std::string effects_text();

/// The same as the tables of docs/scenario.md, one per interface.
[[nodiscard]] std::string effects_markdown();

/// Part of a page that is made from the tables of the catalogue.
struct GeneratedPart {
  std::string name;  // of its markers
  std::string text;
};
/// Those of docs/scenario.md.
[[nodiscard]] std::vector<GeneratedPart> generated_parts();

/// The page with the part as it has to be, between its markers.
/// @throws ConfigError when the page does not have them.
[[nodiscard]] std::string with_generated_part(std::string page, const GeneratedPart& part);

/// The page with every generated part as it has to be, between `<!-- generated: NAME -->` and `<!-- end of NAME -->`.
/// @throws ConfigError for a part whose markers the page does not have.
[[nodiscard]] std::string with_generated_parts(std::string page);

}  // namespace hybridtest
