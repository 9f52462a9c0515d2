#include "experimental_site/interlocks.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace hybridtest {
namespace {

InterfaceVector one(double value) { return InterfaceVector::Constant(1, value); }

struct Sample {
  InterfaceVector target = one(0.01);
  InterfaceVector velocity = one(0.1);
  InterfaceVector command = one(0.012);
  InterfaceVector measured = one(0.0095);
  InterfaceVector force = one(1000.0);
  double energy_ratio = 0.1;
  double age_s = 0.1;
  bool expects_commands = true;
  bool rig_fault = false;

  [[nodiscard]] InterlockVerdict judged(const SiteLimits& limits) const {
    return judge(limits,
                 {target, velocity, command, measured, force, energy_ratio, age_s, expects_commands, rig_fault});
  }
};

const SiteLimits kLimits{.displacement_m = 0.1,
                         .velocity_m_per_s = 1.0,
                         .force_n = 1e5,
                         .tracking_error_m = 0.005,
                         .energy_error_ratio = 0.5,
                         .command_age_s = 1.0};

TEST(InterlocksTest, LetPassWhatIsWithinEveryLimit) { EXPECT_EQ(Sample{}.judged(kLimits).action, SafetyAction::none); }

struct Case {
  const char* what;
  void (*change)(Sample&);
  SafetyAction action;
  FaultFlags fault;
};

class InterlockCases : public testing::TestWithParam<Case> {};

TEST_P(InterlockCases, TripWithTheirActionAndFault) {
  Sample sample;
  GetParam().change(sample);
  const InterlockVerdict verdict = sample.judged(kLimits);
  EXPECT_EQ(verdict.action, GetParam().action);
  EXPECT_EQ(verdict.fault, GetParam().fault);
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    All, InterlockCases,
    testing::Values(
        Case{"target", [](Sample& s) { s.target = one(-0.1001); }, SafetyAction::ramp_to_zero,
             FaultFlags::displacement_limit},
        Case{"measured", [](Sample& s) { s.measured = one(0.1001); }, SafetyAction::ramp_to_zero,
             FaultFlags::displacement_limit},
        Case{"force", [](Sample& s) { s.force = one(-1.01e5); }, SafetyAction::ramp_to_zero, FaultFlags::force_limit},
        Case{"velocity", [](Sample& s) { s.velocity = one(1.01); }, SafetyAction::ramp_to_zero,
             FaultFlags::velocity_limit},
        Case{"tracking", [](Sample& s) { s.measured = one(0.0041); }, SafetyAction::ramp_to_zero,
             FaultFlags::tracking_error},
        Case{"energy", [](Sample& s) { s.energy_ratio = -0.51; }, SafetyAction::ramp_to_zero, FaultFlags::energy_error},
        Case{"age", [](Sample& s) { s.age_s = 1.01; }, SafetyAction::hold, FaultFlags::command_age},
        Case{"rig", [](Sample& s) { s.rig_fault = true; }, SafetyAction::hold, FaultFlags::rig_fault},
        Case{"nan_force", [](Sample& s) { s.force = one(kNan); }, SafetyAction::hold, FaultFlags::not_finite},
        Case{"nan_command", [](Sample& s) { s.command = one(kNan); }, SafetyAction::hold, FaultFlags::not_finite},
        Case{"nan_target", [](Sample& s) { s.target = one(kNan); }, SafetyAction::hold, FaultFlags::not_finite},
        Case{"infinite", [](Sample& s) { s.measured = one(std::numeric_limits<double>::infinity()); },
             SafetyAction::hold, FaultFlags::not_finite}),
    [](const auto& test) { return test.param.what; });

TEST(InterlocksTest, DoNotMindSilenceWhileNoCommandIsExpected) {
  Sample sample;
  sample.age_s = 100.0;
  sample.expects_commands = false;
  EXPECT_EQ(sample.judged(kLimits).action, SafetyAction::none);
}

TEST(InterlocksTest, ALimitThatIsNotSetDoesNotTrip) {
  SiteLimits limits = kLimits;
  limits.tracking_error_m.reset();
  limits.energy_error_ratio.reset();
  Sample sample;
  sample.measured = one(-0.05);
  sample.energy_ratio = 99.0;
  EXPECT_EQ(sample.judged(limits).action, SafetyAction::none);
}

TEST(InterlocksTest, NotFiniteOutranksEverythingElse) {
  Sample sample;
  sample.force = one(kNan);
  sample.target = one(5.0);
  EXPECT_EQ(sample.judged(kLimits).fault, FaultFlags::not_finite);
}

}  // namespace
}  // namespace hybridtest
