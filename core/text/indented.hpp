#pragma once

#include <string>
#include <string_view>

namespace hybridtest {

/// Lines with text in front of each, empty ones left out.
/// @param first    of the first line.
/// @param others   of all others.
[[nodiscard]] std::string indented(std::string_view lines, std::string_view first, std::string_view others);

}  // namespace hybridtest
