#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "tests/support/shared_data.hpp"
#include "tests/support/system_fixture.hpp"
#include "tests/system/reference_building.hpp"

/// The linear two-storey building with an actuator that answers 20 ms late: four times the delay at which its
/// second mode starts to grow (5.4 ms).
namespace hybridtest {
namespace {

class LateActuator : public SystemTest {
 protected:
  void SetUp() override {
    HYBRIDTEST_NEEDS_DATA(recorded_reference("linear"));
    HYBRIDTEST_NEEDS_DATA(reference_motion());
    reference_ = read_reference(recorded_reference("linear"));
  }

  [[nodiscard]] StartedProgram start_with(const std::string& compensator) const {
    return start_run(system_scenario("two_storey_reference"), "run",
                     {"--set", "excitation.ground_motion=" + reference_motion().string(), "--set",
                      "substructures[storey_1].rig.transfer_system={type: delay, delay_s: 0.020}", "--set",
                      "substructures[storey_1].compensator=" + compensator});
  }

  ReferenceHistory reference_;
};

TEST_F(LateActuator, UncompensatedTestEndsByEnergyInterlock) {
  StartedProgram run = start_with("{type: none}");
  ASSERT_THAT(run.wait(), ::testing::Optional(kExitEndedEarly)) << run.standard_error();

  const nlohmann::json summary = recorded("run").summary();
  EXPECT_EQ(summary["stop_reason"], "interlock");
  ASSERT_FALSE(summary["interlocks"].empty());
  const nlohmann::json& interlock = summary["interlocks"][0];
  EXPECT_EQ(interlock["participant"], "storey_1");
  EXPECT_EQ(interlock["limit_name"], "energy_error");
  // The delay adds energy: a negative energy error.
  EXPECT_LT(interlock["observed"].get<double>(), -interlock["limit"].get<double>());

  // The late force does work on the structure: energy from the delay, more in every quarter of the test.
  const auto steps = static_cast<std::size_t>(summary["completed_steps"]);
  const std::vector<double> energy_j = recorded("run").column("storey_1", "control", "energy_error_j");
  ASSERT_GT(energy_j.size(), steps);
  std::cout << "no compensation: ended by " << interlock["limit_name"] << " after " << summary["model_time_s"]
            << " s; energy error";
  double before_j = 0.0;
  for (std::size_t quarter = 1; quarter <= 4; ++quarter) {
    const double now_j = energy_j[quarter * steps / 4];
    std::cout << ' ' << now_j << " J";
    EXPECT_LT(now_j, 2.0 * before_j) << "quarter " << quarter;
    before_j = now_j;
  }
  std::cout << '\n';
  const ReferenceDistance distance = distance_from(reference_, recorded("run"));
  std::cout << "no compensation: largest displacement error " << 100.0 * distance.floor_1 << " % (floor 1), "
            << 100.0 * distance.floor_2 << " % (floor 2) of the peak by then\n";
}

TEST_F(LateActuator, PolynomialCompensationStaysNearReference) {
  StartedProgram run = start_with("{type: polynomial_displacement, order: 3, delay_s: 0.020}");
  ASSERT_THAT(run.wait(), ::testing::Optional(kExitCompleted)) << run.standard_error();

  const ReferenceDistance distance = distance_from(reference_, recorded("run"));
  std::cout << "polynomial displacement, order 3: completed; largest displacement error " << 100.0 * distance.floor_1
            << " % (floor 1), " << 100.0 * distance.floor_2 << " % (floor 2) of the peak\n";
  EXPECT_EQ(distance.samples, 3100U);
  // An independent computation of the same building (central difference, the polynomial through targets 20 ms
  // apart, 20 steps of delay; nothing else) is off by 1.33 % and 0.66 %: what order 3 leaves of the delay of the
  // second mode, (20.74 rad/s 0.02 s)^4 = 3 % of its amplitude. The rest is up to 5 % more of that.
  EXPECT_LE(distance.floor_1, 0.0140);
  EXPECT_LE(distance.floor_2, 0.0069);
}

}  // namespace
}  // namespace hybridtest
