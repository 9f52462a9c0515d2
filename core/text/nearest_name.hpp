#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hybridtest {

/// The name in `known` with the smallest edit distance to `name`, if it is near enough to be a
/// likely misspelling (at most a third of its length, at least one edit allowed). A swap of two
/// neighbouring letters is one edit; of several nearest the first.
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known);

}  // namespace hybridtest
