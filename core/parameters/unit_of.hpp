#pragma once

#include <string>
#include <string_view>

namespace hybridtest {

/// The unit that ends the name of a parameter: `N/m` for `stiffness_n_per_m`; empty when it does not end in a unit.
[[nodiscard]] std::string unit_of(std::string_view name);

}  // namespace hybridtest
