#include "scenario/test_stability.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::filesystem::path shipped(const std::string& name) {
  return std::filesystem::path{HYBRIDTEST_SOURCE_DIR} / "launch" / "scenarios" / (name + ".yaml");
}

TestStability stability_of(const Scenario& scenario) {
  return test_stability(scenario, vibration_modes(scenario.structure));
}

class TestStabilityTest : public testing::Test {
 protected:
  [[nodiscard]] Scenario read(const std::vector<std::string>& overrides) const {
    return file_.read(kScenarioText, overrides);
  }
  [[nodiscard]] SiteStability site(const std::vector<std::string>& overrides) const {
    scenario_ = read(overrides);
    return stability_of(scenario_).sites.at(0);
  }
  [[nodiscard]] std::vector<std::string> stiffness_errors(const std::string& matrix) const {
    return file_.errors(kScenarioText, {"substructures[storey_1].initial_stiffness_n_per_m=" + matrix});
  }

  static constexpr double kDelay_s = 0.0230986;  // of the second-order actuator, 0.9/(15 pi) + 0.004
  ScenarioFile file_;
  mutable Scenario scenario_;  // that the last result points to
};

const std::string kNoCompensator = "substructures[storey_1].compensator={type: none}";
const std::string kForce = "substructures[storey_1].force_compensator=";

TEST_F(TestStabilityTest, ForceCompensatorsCount) {
  EXPECT_TRUE(site({kNoCompensator}).is_unstable());
  EXPECT_NEAR(site({kNoCompensator}).delay.remaining_s, kDelay_s, 1e-6);
  for (const char* type :
       {"{type: polynomial_force, delay_s: 0.023, point_spacing_s: 0.02}", "{type: force_correction, horizon_s: 0.03}",
        "{type: force_correction_quadratic, points: 3, point_spacing_s: 0.012}"}) {
    const SiteStability compensated = site({kNoCompensator, kForce + type});
    EXPECT_FALSE(compensated.is_unstable()) << type;
    EXPECT_NEAR(compensated.delay.remaining_s, 0.0, 1.5e-4) << type;
    EXPECT_NEAR(compensated.delay.after_command_s, kDelay_s, 1e-6) << "which the tracking error shows";
  }
  EXPECT_NEAR(site({kNoCompensator, kForce + "{type: force_correction, horizon_s: 0.01}"}).delay.remaining_s,
              kDelay_s - 0.01, 1e-6)
      << "no further than its horizon";
  EXPECT_NEAR(site({kNoCompensator, kForce + "{type: optimal_pick}"}).delay.remaining_s, kDelay_s, 1e-6)
      << "which looks back only";
}

TEST_F(TestStabilityTest, FoundingStudyIsAsItCompletes) {
  for (const char* method : {"exact", "force_correction", "force_correction_quadratic", "newmark_kinematics",
                             "polynomial_displacement", "polynomial_force", "uncompensated"}) {
    const Scenario scenario = read_scenario(shipped(std::string{"founding_study/"} + method), {});
    EXPECT_EQ(stability_of(scenario).is_unstable(scenario.time.step_s), std::string_view{method} == "uncompensated")
        << method;
  }
}

TEST_F(TestStabilityTest, EachDofHasItsOwnDelay) {
  const Scenario scenario = read_scenario(
      shipped("founding_study/polynomial_displacement"),
      {"substructures[laboratory].rig.transfer_system=[{type: delay, delay_s: 0.010}, {type: delay, delay_s: 0.020}]",
       "substructures[laboratory].compensator=[{type: polynomial_displacement, delay_s: 0.010, point_spacing_s: "
       "0.005}, "
       "{type: polynomial_displacement, delay_s: 0.020, point_spacing_s: 0.005}]"});
  EXPECT_EQ(stability_of(scenario).sites.at(0).delay.remaining_s, 0.0);
}

TEST_F(TestStabilityTest, DelayThatIsLearntIsNotCalledUnstable) {
  const SiteStability learnt = site({"substructures[storey_1].compensator={type: adaptive_inverse, delay_s: 0.005}"});
  EXPECT_LT(learnt.margin_s(), 0.0);
  EXPECT_FALSE(learnt.is_unstable());
  EXPECT_TRUE(site({"substructures[storey_1].compensator={type: inverse_compensation, delay_s: 0.005}"}).is_unstable());
}

TEST_F(TestStabilityTest, SimulatedSpecimenIsWhatTheTestMeets) {
  const SiteStability sound = site({});
  EXPECT_LT(sound.stiffness_error, 1e-9);
  EXPECT_FALSE(sound.is_unstable());
  const SiteStability wrong = site({"substructures[storey_1].initial_stiffness_n_per_m=[[2.0]]", kNoCompensator,
                                    "structure.damping={type: matrix, matrix_n_s_per_m: [[3.0e4, 0], [0, 3.0e4]]}"});
  EXPECT_NEAR(wrong.stiffness_error, 1.0, 1e-6);
  EXPECT_NEAR(wrong.specimen_stiffness_n_per_m(0, 0), 4.0e6, 1.0);
  EXPECT_TRUE(stability_of(scenario_).has_wrong_stiffness());
  EXPECT_TRUE(wrong.is_unstable()) << "2 N/m alone would be stable at any delay";
  const SiteStability softer = site({"substructures[storey_1].rig.specimen.stiffness_n_per_m=3.0e6"});
  EXPECT_NEAR(softer.stiffness_error, 0.25, 1e-9);
  EXPECT_FALSE(stability_of(scenario_).has_wrong_stiffness()) << "only warned of";
  const SiteStability gap =
      site({"substructures[storey_1].rig.specimen={type: gap, stiffness_n_per_m: 4.0e6, gap_m: 0.01}"});
  EXPECT_EQ(gap.stiffness_error, 0.0) << "its stiffness does not show at rest";
  const SiteStability laboratory =
      site({"substructures[storey_1].rig={type: udp, host: a, port: 1, pace: datagrams, transfer_delay_s: 0.0231}"});
  EXPECT_EQ(laboratory.specimen_stiffness_n_per_m.size(), 0);
  EXPECT_FALSE(laboratory.is_unstable());
}

TEST_F(TestStabilityTest, SpecimenBehindGeometryIsThatOfTheDofs) {
  const SiteStability lever =
      site({"substructures[storey_1].rig={type: simulated, transfer_system: {type: ideal}, specimen: {type: elastic, "
            "stiffness_n_per_m: 1.0e6}, geometry: {type: linear, matrix: [[2.0]]}}"});
  EXPECT_NEAR(lever.specimen_stiffness_n_per_m(0, 0), 4.0e6, 1.0);
  EXPECT_LT(lever.stiffness_error, 1e-9);
}

TEST_F(TestStabilityTest, StepIsJudgedBySpecimen) {
  const Scenario stiff = read({"substructures[storey_1].rig.specimen.stiffness_n_per_m=4.0e11",
                               "substructures[storey_1].rig.specimen.yield_force_n=4.0e12"});
  const TestStability stability = stability_of(stiff);
  EXPECT_LT(stability.step.step_s_max, 0.001);
  EXPECT_TRUE(stability.is_unstable(0.001));
}

TEST_F(TestStabilityTest, DelayCountsBesideModesBeyondTheStep) {
  const std::vector<std::string> fast{"integrator={type: cr}",
                                      "substructures[storey_2].model.stiffness_n_per_m=1.0e11"};
  const TestStability compensated = stability_of(read(fast));
  EXPECT_TRUE(compensated.has_modes_beyond_step);
  EXPECT_FALSE(compensated.is_unstable(0.001));
  const TestStability late = stability_of(read({fast[0], fast[1], kNoCompensator}));
  EXPECT_TRUE(late.grows);
  EXPECT_TRUE(late.is_unstable(0.001));
  EXPECT_FALSE(stability_of(read({fast[0]})).has_modes_beyond_step);
}

TEST_F(TestStabilityTest, StifferSpecimenIsTriedWithTheIntegrator) {
  // omega dt of the excess: 0.014 with 4 MN/m beside 2 MN/m, 4.5 with 4e11 N/m.
  EXPECT_FALSE(
      stability_of(read({"integrator={type: cr}", "substructures[storey_1].initial_stiffness_n_per_m=[[3e6]]"})).grows);
  EXPECT_TRUE(
      stability_of(read({"integrator={type: cr}", "substructures[storey_1].rig.specimen.stiffness_n_per_m=4.0e11",
                         "substructures[storey_1].rig.specimen.yield_force_n=4.0e12"}))
          .grows);
}

TEST_F(TestStabilityTest, InitialStiffnessMustNotBeNegative) {
  EXPECT_THAT(stiffness_errors("[[-2.0e6]]"), Contains(HasSubstr("initial_stiffness_n_per_m: is negative")));
  EXPECT_THAT(stiffness_errors("[[4.0e6]]"), IsEmpty());
  const std::string two = with("interface: [{dof: floor_1}]", "interface: [{dof: floor_1}, {dof: floor_2}]");
  const auto errors = [&](const std::string& matrix) {
    return file_.errors(two, {"substructures[storey_1].initial_stiffness_n_per_m=" + matrix});
  };
  EXPECT_THAT(errors("[[1.0, 2.0], [2.0, 1.0]]"), Contains(HasSubstr("is negative in some direction")));
  EXPECT_THAT(errors("[[1.0, 2.0], [0.0, 5.0]]"), Contains(HasSubstr("expected a symmetric matrix")));
  EXPECT_THAT(errors("[[3.0, -3.0], [-3.0, 3.0]]"), testing::Not(Contains(HasSubstr("initial_stiffness"))))
      << "a spring between two floors";
}

}  // namespace
}  // namespace hybridtest
