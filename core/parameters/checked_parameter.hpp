#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/parameters/range.hpp"

namespace hybridtest {

/// `<name> is <value>; expected <range>, because <reason>`; without a reason the range in full words.
[[nodiscard]] std::string out_of_range(std::string_view name, double value, const Range& range,
                                       std::string_view reason = {});

/// @param reason   completes "…, because"; why the range is what it is.
/// @throws ConfigError naming the parameter, its value and what was expected, unless the value lies in its range.
///         NaN and infinity lie in no range.
void expect_in_range(std::string_view name, double value, const Range& range, std::string_view reason = {});

/// Hands a parameter on once it lies in its range, for constructors.
[[nodiscard]] double checked(std::string_view name, double value, const Range& range, std::string_view reason = {});

/// @return `control_period_s`.
/// @throws ConfigError outside 1 microsecond to 1 second.
double checked_control_period(double control_period_s);

/// A span of time in control periods, rounded to the nearest.
/// @throws ConfigError where that is less than `periods_min` or more than a million, the memory that a history may
/// take.
std::size_t checked_periods(std::string_view name, double span_s, double control_period_s, std::size_t periods_min,
                            std::string_view reason);

}  // namespace hybridtest
