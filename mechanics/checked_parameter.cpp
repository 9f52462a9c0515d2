#include "mechanics/checked_parameter.hpp"

#include <cmath>
#include <string>

#include "core/config/error.hpp"
#include "core/config/scalar.hpp"
#include "core/config/value_reader.hpp"

namespace hybridtest {
namespace {

std::string written(double value) {
  if (std::isfinite(value)) return config::written_number(value);
  return std::isnan(value) ? "NaN" : "infinite";
}

}  // namespace

double checked(std::string_view name, double value, const config::Range& range) {
  if (std::isfinite(value) && config::contains(range, value)) return value;
  throw ConfigError{std::string{name} + " is " + written(value) + "; expected " + config::expected_number(range)};
}

}  // namespace hybridtest
