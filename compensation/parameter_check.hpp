#pragma once

#include <cstddef>
#include <string_view>

namespace hybridtest {

/// From `low` to `high`; `high` belongs to it, `low` where it says so.
struct ParameterRange {
  double low = 0.0;
  double high = 0.0;
  bool includes_low = true;
};

/// @param reason   completes "…, because"; why the range is what it is.
/// @return `value`.
/// @throws ConfigError `<name> is <value>; expected <range>, because <reason>` outside the range, NaN included.
double checked_parameter(std::string_view name, double value, ParameterRange range, std::string_view reason);

/// @return `control_period_s`.
/// @throws ConfigError outside 1 microsecond to 1 second.
double checked_control_period(double control_period_s);

/// A span of time in control periods, rounded to the nearest.
/// @throws ConfigError where that is less than `least` or more than a million, the memory that a history may take.
std::size_t checked_periods(std::string_view name, double span_s, double control_period_s, std::size_t least,
                            std::string_view reason);

}  // namespace hybridtest
