#pragma once

#include <array>
#include <string>
#include <string_view>

#include "core/messages.hpp"

namespace hybridtest {

/// One sentence for people: what happened, to whom, with its values and units.
[[nodiscard]] std::string describe(const Event& event);

/// What an interlock found, by the name of its fault: `force_limit (observed 1200 N, limit 1000 N)`, or the reason of a
/// fault that has no observed value.
[[nodiscard]] std::string interlock_cause(std::string_view fault, const std::array<double, 2>& values);
/// Whether the two values are an observed value and a limit, in SI units.
[[nodiscard]] bool has_observed_value(std::string_view fault) noexcept;

}  // namespace hybridtest
