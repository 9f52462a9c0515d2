#include "core/parameters/checked_parameter.hpp"

#include <cmath>

#include "core/config_error.hpp"
#include "core/text/scalar.hpp"

namespace hybridtest {
namespace {

constexpr double kPeriodsMax = 1e6;

std::string written(double value) {
  if (std::isfinite(value)) return written_number(value);
  return std::isnan(value) ? "NaN" : "infinite";
}

}  // namespace

std::string out_of_range(std::string_view name, double value, const Range& range, std::string_view reason) {
  const std::string found = std::string{name} + " is " + written(value) + "; expected ";
  return reason.empty() ? found + expected_number(range)
                        : found + values_in(range) + ", because " + std::string{reason};
}

void expect_in_range(std::string_view name, double value, const Range& range, std::string_view reason) {
  if (std::isfinite(value) && contains(range, value)) return;
  throw ConfigError{out_of_range(name, value, range, reason)};
}

double checked(std::string_view name, double value, const Range& range, std::string_view reason) {
  expect_in_range(name, value, range, reason);
  return value;
}

double checked_control_period(double control_period_s) {
  return checked("control_period_s", control_period_s, {.low = 1e-6, .high = 1.0},
                 "a control loop samples at 1 Hz to 1 MHz");
}

std::size_t checked_periods(std::string_view name, double span_s, double control_period_s, std::size_t periods_min,
                            std::string_view reason) {
  const double periods = std::round(span_s / control_period_s);
  if (periods >= static_cast<double>(periods_min) && periods <= kPeriodsMax) return static_cast<std::size_t>(periods);
  throw ConfigError{std::string{name} + " is " + written_number(span_s) + "; expected " +
                    written_integer(static_cast<std::int64_t>(periods_min)) + " to 1000000 control periods of " +
                    written_number(control_period_s) + " s, because " + std::string{reason}};
}

}  // namespace hybridtest
