#include "core/parameters/checked_parameter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

std::string refusal(double value, const Range& range) {
  try {
    static_cast<void>(checked("ratio", value, range));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(CheckedParameter, ReturnsValueInRange) {
  EXPECT_EQ(checked("ratio", 0.0, kNotNegative), 0.0);
  EXPECT_EQ(checked("ratio", -3.5, kAnyNumber), -3.5);
}

TEST(CheckedParameter, ErrorNamesParameterValueAndRange) {
  EXPECT_EQ(refusal(-2.5, kPositive), "ratio is -2.5; expected a number greater than 0");
  EXPECT_EQ(refusal(NAN, kAnyNumber), "ratio is NaN; expected a finite number");
  EXPECT_EQ(refusal(INFINITY, kPositive), "ratio is infinite; expected a number greater than 0");
}

}  // namespace
}  // namespace hybridtest
