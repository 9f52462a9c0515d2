#pragma once

#include <string>
#include <vector>

#include "tests/architecture/source_tree.hpp"

/// How the parts may depend on each other and on what is outside: the table of DESIGN section 2
/// and the rules of section 3, as tables.
namespace hybridtest::architecture {

/// Everything in the files that the rules do not allow, one sentence each.
[[nodiscard]] std::vector<std::string> violations(const std::vector<SourceFile>& files);

}  // namespace hybridtest::architecture
