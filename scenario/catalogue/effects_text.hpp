#pragma once

#include <string>

namespace hybridtest {

/// The effect library for a terminal.
[[nodiscard]] std::string effects_text();

/// The same as the tables of docs/scenario.md, one per interface.
[[nodiscard]] std::string effects_markdown();

}  // namespace hybridtest
