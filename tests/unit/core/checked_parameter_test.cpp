#include "core/parameters/checked_parameter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/config_error.hpp"
#include "core/parameters/parameter_checker.hpp"

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

std::string refusal(double value, const Range& range, std::string_view reason = {}) {
  return refusal([&] { expect_in_range("ratio", value, range, reason); });
}

TEST(CheckedParameter, ReturnsValueInRange) {
  EXPECT_EQ(checked("ratio", 0.0, kNotNegative), 0.0);
  EXPECT_EQ(checked("ratio", -3.5, kAnyNumber), -3.5);
  EXPECT_EQ(checked_control_period(0.001), 0.001);
  EXPECT_EQ(checked_periods("window_s", 0.0104, 0.001, 3, ""), 10U);
}

TEST(CheckedParameter, ErrorNamesParameterValueAndRange) {
  EXPECT_EQ(refusal(-2.5, kPositive), "ratio is -2.5; expected a number greater than 0");
  EXPECT_EQ(refusal(NAN, kAnyNumber), "ratio is NaN; expected a finite number");
  EXPECT_EQ(refusal(INFINITY, kPositive), "ratio is infinite; expected a number greater than 0");
}

TEST(CheckedParameter, ErrorNamesReason) {
  EXPECT_EQ(refusal(-0.5, kZeroToOne, "time goes on"), "ratio is -0.5; expected 0 to 1, because time goes on");
  EXPECT_EQ(refusal(0.0, {.low = 0.0, .high = 2.0, .low_open = true}, "it divides"),
            "ratio is 0; expected more than 0, at most 2, because it divides");
  EXPECT_EQ(refusal(NAN, {.low = 0.0, .high = 2.0}, "it divides"), "ratio is NaN; expected 0 to 2, because it divides");
}

TEST(CheckedParameter, RefusesTooFewOrTooManyPeriods) {
  EXPECT_EQ(refusal([] { checked_periods("window_s", 0.001, 0.001, 3, "a fit has three points"); }),
            "window_s is 0.001; expected 3 to 1000000 control periods of 0.001 s, because a fit has three points");
  EXPECT_NE(refusal([] { checked_periods("window_s", INFINITY, 0.001, 3, ""); }), "");
  EXPECT_NE(refusal([] { checked_control_period(0.0); }), "");
}

TEST(ValuesIn, WritesEveryKindOfRange) {
  EXPECT_EQ(values_in(kAnyNumber), "any");
  EXPECT_EQ(values_in(kPositive), "more than 0");
  EXPECT_EQ(values_in(kNotNegative), "at least 0");
  EXPECT_EQ(values_in(kZeroToOne), "0 to 1");
  EXPECT_EQ(values_in(kZeroToBelowOne), "0 to below 1");
  EXPECT_EQ(values_in({.high = 3.0}), "at most 3");
}

struct Valve {
  double frequency_hz = 50.0;

  void serialize(ParameterArchive& archive) {
    archive.optional("frequency_hz", frequency_hz, {kPositive, "of the spool", "the spool moves"});
  }
};

struct Actuator {
  double gain = 1.0;
  Duration delay{};
  int order = 3;
  double time_constant_s = 0.1;
  double bandwidth_hz = 0.0;
  Valve valve{};

  void serialize(ParameterArchive& archive) {
    archive.required("gain", gain, {kPositive, "of the commands"});
    archive.optional("delay_s", delay, {kZeroToOne, "of the actuator"});
    archive.optional("order", order, {{.low = 1.0, .high = 4.0}, "of the polynomial"});
    archive.either({"time_constant_s", time_constant_s, {kPositive, "of the lag"}},
                   {"bandwidth_hz", bandwidth_hz, {kPositive, "of the lag"}});
    archive.section("valve", valve, "the servo-valve");
  }
};

std::string refusal_of(const Actuator& actuator) {
  return refusal([&] { static_cast<void>(checked(actuator)); });
}

TEST(ParameterChecker, ReturnsParametersInRange) {
  EXPECT_EQ(refusal_of({}), "");
  EXPECT_EQ(checked(Actuator{.delay = Duration{123'456'789}}).delay, Duration{123'456'789});
}

TEST(ParameterChecker, RefusesAParameterOfAnyTypeOutOfRange) {
  EXPECT_EQ(refusal_of({.gain = 0.0}), "gain is 0; expected a number greater than 0");
  EXPECT_EQ(refusal_of({.delay = from_seconds(2.0)}), "delay_s is 2; expected a number from 0 to 1");
  EXPECT_EQ(refusal_of({.order = 5}), "order is 5; expected a number from 1 to 4");
  EXPECT_EQ(refusal_of({.valve = {-1.0}}), "frequency_hz is -1; expected more than 0, because the spool moves");
}

TEST(ParameterChecker, ChecksTheAlternativeThatIsGiven) {
  EXPECT_EQ(refusal_of({.time_constant_s = 0.0}), "time_constant_s is 0; expected a number greater than 0");
  EXPECT_EQ(refusal_of({.time_constant_s = 0.0, .bandwidth_hz = 5.0}), "");
  EXPECT_EQ(refusal_of({.bandwidth_hz = -5.0}), "bandwidth_hz is -5; expected a number greater than 0");
}

}  // namespace
}  // namespace hybridtest
