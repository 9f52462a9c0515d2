#include "compensation/parameter_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

std::string refusal(auto&& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

TEST(ParameterCheck, NamesValueRangeAndReason) {
  EXPECT_EQ(refusal([] {
              checked_parameter("delay_s", -0.5, {0.0, 1.0}, "time goes on");
            }),
            "delay_s is -0.5; expected 0 to 1, because time goes on");
  EXPECT_EQ(refusal([] {
              checked_parameter("gain", 0.0, {0.0, 2.0, false}, "it divides");
            }),
            "gain is 0; expected more than 0, at most 2, because it divides");
  EXPECT_EQ(refusal([] {
              checked_parameter("gain", std::nan(""), {0.0, 2.0}, "it divides");
            }),
            "gain is nan; expected 0 to 2, because it divides");
  EXPECT_EQ(refusal([] { checked_periods("window_s", 0.001, 0.001, 3, "a fit has three points"); }),
            "window_s is 0.001; expected 3 to 1000000 control periods of 0.001 s, because a fit has three points");
}

TEST(ParameterCheck, ReturnsAcceptedValue) {
  EXPECT_EQ(checked_parameter("delay_s", 0.0, {0.0, 1.0}, ""), 0.0);
  EXPECT_EQ(checked_parameter("delay_s", 1.0, {0.0, 1.0}, ""), 1.0);
  EXPECT_EQ(checked_periods("window_s", 0.0104, 0.001, 3, ""), 10U);
  EXPECT_EQ(checked_control_period(0.001), 0.001);
  EXPECT_NE(refusal([] { checked_control_period(0.0); }), "");
  EXPECT_NE(refusal([] { checked_periods("window_s", INFINITY, 0.001, 3, ""); }), "");
}

}  // namespace
}  // namespace hybridtest
