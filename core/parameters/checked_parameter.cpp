#include "core/parameters/checked_parameter.hpp"

#include <cmath>
#include <string>

#include "core/config_error.hpp"
#include "core/text/scalar.hpp"

namespace hybridtest {
namespace {

std::string written(double value) {
  if (std::isfinite(value)) return written_number(value);
  return std::isnan(value) ? "NaN" : "infinite";
}

}  // namespace

double checked(std::string_view name, double value, const Range& range) {
  if (std::isfinite(value) && contains(range, value)) return value;
  throw ConfigError{std::string{name} + " is " + written(value) + "; expected " + expected_number(range)};
}

}  // namespace hybridtest
