#include "validation/studies/rths_benchmark/control_path.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "validation/studies/rths_benchmark/constants.hpp"
#include "validation/studies/rths_benchmark/converter.hpp"

namespace hybridtest::rths {
namespace {

TEST(Converter, HasEighteenFractionBitsAndSaturates) {
  EXPECT_EQ(quantised(0.4 / 262144.0), 0.0);
  EXPECT_EQ(quantised(0.6 / 262144.0), 1.0 / 262144.0);
  EXPECT_EQ(saturated(5.0), 3.8);
  EXPECT_EQ(saturated(-5.0), -3.8);
}

TEST(ReleasedLoop, IsProportionalAndIntegratesByTrapezoidalRule) {
  ReleasedLoop loop;
  const double error = quantised(0.001);
  // First sample: half of the trapezoid before it is the error of rest.
  EXPECT_EQ(loop.command(error, 0.0), quantised(2.0 * error + 95.0 * 0.5 * kPeriodS * error));
  double integral = 0.5 * kPeriodS * error;
  for (int i = 0; i < 100; ++i) integral += kPeriodS * error;
  double command = 0.0;
  for (int i = 0; i < 100; ++i) command = loop.command(error, 0.0);
  EXPECT_NEAR(command, 2.0 * error + 95.0 * integral, 0x1p-18);
}

TEST(ReleasedController, LeadHasUnitStaticGainAndCornerRatio) {
  ReleasedController controller;
  // Held at the displacement that the lead asks for in the end: the error vanishes.
  const double target = quantised(0.002);
  double command = 0.0;
  const double first = controller.command({.target_m = target});
  for (int i = 0; i < 2000; ++i) command = controller.command({.target_m = target, .measured_displacement_m = target});
  const double again = controller.command({.target_m = target, .measured_displacement_m = target});
  EXPECT_EQ(command, again);
  // (b1 w + b0)/(w + b0) with w = 8192: of the first answer to a step, through Kp and half a period of Ki.
  const double lead = (50.83163360273612 * 8192.0 + 8570.397339444286) / (8192.0 + 8570.397339444286);
  EXPECT_NEAR(first, (2.0 + 95.0 * 0.5 * kPeriodS) * lead * target, 3.0 * 0x1p-18);
}

/// Hands on what it was given last.
class Witness final : public Compensator {
 public:
  explicit Witness(CompensatorInput& seen) : seen_{seen} {}
  [[nodiscard]] double command(const CompensatorInput& input) noexcept override {
    seen_ = input;
    return 10.0;
  }
  void reset() noexcept override {}

 private:
  CompensatorInput& seen_;
};

TEST(CompensatedPath, UsesPreviousMeasurementAndSaturatesCommand) {
  CompensatorInput seen;
  CompensatedPath path{std::make_unique<Witness>(seen), Arrangement::straight};
  const double command = path.command({.target_m = 0.001,
                                       .target_velocity_m_per_s = 0.02,
                                       .target_acceleration_m_per_s2 = 0.3,
                                       .measured_displacement_m = 7.0,
                                       .previous_displacement_m = 0.0011,
                                       .previous_force_n = 123.4});
  EXPECT_EQ(command, 3.8);
  EXPECT_EQ(seen.target_m, 0.001);
  EXPECT_EQ(seen.target_velocity_m_per_s, 0.02);
  EXPECT_EQ(seen.target_acceleration_m_per_s2, 0.3);
  EXPECT_EQ(seen.measured_displacement_m, quantised(0.0011));
  EXPECT_EQ(seen.measured_force_n, 123.4);
}

}  // namespace
}  // namespace hybridtest::rths
