#pragma once

#include <string>

#include "core/config/node.hpp"

namespace hybridtest::config {

/// The node as found: `the number 5`, `the text "abc"`, `a list`, `nothing`.
[[nodiscard]] std::string described(const Node& node);

}  // namespace hybridtest::config
