#include "compensation/parameter_check.hpp"

#include <cmath>
#include <string>

#include "core/config_error.hpp"
#include "core/text/scalar.hpp"

namespace hybridtest {
namespace {

constexpr double kMaxPeriods = 1e6;

std::string described(ParameterRange range) {
  const std::string low = written_number(range.low);
  const std::string high = written_number(range.high);
  return range.includes_low ? low + " to " + high : "more than " + low + ", at most " + high;
}

}  // namespace

double checked_parameter(std::string_view name, double value, ParameterRange range, std::string_view reason) {
  const bool is_above_low = range.includes_low ? value >= range.low : value > range.low;
  if (is_above_low && value <= range.high) return value;
  throw ConfigError{std::string{name} + " is " + written_number(value) + "; expected " + described(range) +
                    ", because " + std::string{reason}};
}

double checked_control_period(double control_period_s) {
  return checked_parameter("control_period_s", control_period_s, {1e-6, 1.0},
                           "a control loop samples at 1 Hz to 1 MHz");
}

std::size_t checked_periods(std::string_view name, double span_s, double control_period_s, std::size_t least,
                            std::string_view reason) {
  const double periods = std::round(span_s / control_period_s);
  if (periods >= static_cast<double>(least) && periods <= kMaxPeriods) return static_cast<std::size_t>(periods);
  throw ConfigError{std::string{name} + " is " + written_number(span_s) + "; expected " +
                    written_integer(static_cast<std::int64_t>(least)) + " to 1000000 control periods of " +
                    written_number(control_period_s) + " s, because " + std::string{reason}};
}

}  // namespace hybridtest
