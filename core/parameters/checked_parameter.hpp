#pragma once

#include <string_view>

#include "core/parameters/range.hpp"

namespace hybridtest {

/// Hands a parameter on once it lies in its range, for constructors.
/// @throws ConfigError naming the parameter, its value and what was expected; NaN and infinity
///         lie in no range.
[[nodiscard]] double checked(std::string_view name, double value, const Range& range);

}  // namespace hybridtest
