#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config_error.hpp"
#include "runtime/simulation.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

/// What a scenario says of a site's rig.
namespace hybridtest {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class RigsTest : public testing::Test {
 protected:
  [[nodiscard]] Scenario read(const std::string& rig, const std::vector<std::string>& more = {}) const {
    return file_.read(kScenarioText, overrides(rig, more));
  }
  [[nodiscard]] std::vector<std::string> errors(const std::string& rig,
                                                const std::vector<std::string>& more = {}) const {
    return file_.errors(kScenarioText, overrides(rig, more));
  }
  [[nodiscard]] static std::vector<std::string> tables(const Scenario& scenario) {
    std::vector<std::string> names;
    for (const TableLayout& table : scenario.substructures[0].site.rig_tables) names.push_back(table.name);
    return names;
  }

 private:
  [[nodiscard]] static std::vector<std::string> overrides(const std::string& rig, std::vector<std::string> more) {
    more.insert(more.begin(), "substructures[storey_1].rig=" + rig);
    return more;
  }
  ScenarioFile file_;
};

const std::string kPaced = "time.mode=paced";

TEST_F(RigsTest, UdpRigRequiresAddressAndPace) {
  const Scenario scenario = read("{type: udp, host: rig.example, port: 5000, transfer_delay_s: 0.02}", {kPaced});
  EXPECT_EQ(scenario.substructures[0].site.rig_type, "udp");
  EXPECT_EQ(scenario.substructures[0].site.delays.at(0).transfer_s, 0.02);
  EXPECT_TRUE(scenario.substructures[0].site.rig_is_elsewhere);
  EXPECT_THAT(tables(scenario), ElementsAre("rig_link"));
  EXPECT_THAT(errors("{type: udp}", {kPaced}), AllOf(Contains(HasSubstr("rig.host")), Contains(HasSubstr("rig.port"))));
  EXPECT_THAT(errors("{type: udp, host: a, port: 70000}", {kPaced}), Contains(HasSubstr("rig.port")));
  EXPECT_THAT(errors("{type: udp, host: a, port: 1, reply_wait_s: 0.0005}", {kPaced}),
              Contains(HasSubstr("reply_wait_s")))
      << "as long as a control period";
  EXPECT_THAT(errors("{type: udp, host: a, port: 1, watchdog_s: 0.0005}", {kPaced}), Contains(HasSubstr("watchdog_s")))
      << "shorter than two control periods";
}

TEST_F(RigsTest, InputsHaveTheirNominalValueInASimulatedRig) {
  const auto nominal_of = [&](const std::string& effects) {
    const std::string parts =
        "{type: simulated, transfer_system: {type: ideal}, specimen: {type: elastic, stiffness_n_per_m: 4.0e6}";
    return read(parts + effects + "}").substructures[0].site.nominal_inputs;
  };
  EXPECT_THAT(nominal_of(""), IsEmpty());
  EXPECT_THAT(nominal_of(", effects: [{interface: specimen, effect: force_with_input, input: current_a, "
                         "force_ratio_per_unit: 0.1, nominal_input: 2.5}, {interface: specimen, effect: "
                         "damping_with_input, input: current_a, damping_n_s_per_m_per_unit: 1.0, nominal_input: 2.5}]"),
              ElementsAre("current_a at 2.5"));
}

TEST_F(RigsTest, LinearServoHydraulicBringsItsSpecimen) {
  const Scenario scenario = read("{type: simulated, transfer_system: {type: linear_servo_hydraulic}}");
  const SiteScenario& site = scenario.substructures[0].site;
  EXPECT_EQ(site.specimen_stiffness_n_per_m(0.01)(0, 0), 1.190e6);
  // Published: the slope of the phase at zero frequency, and with it the lag of slow motion.
  EXPECT_NEAR(site.delays.at(0).transfer_s, 0.02508, 1e-5);
  EXPECT_THAT(errors("{type: simulated, transfer_system: {type: linear_servo_hydraulic}, specimen: {type: none}}"),
              Contains(AllOf(HasSubstr("rig.specimen"), HasSubstr("expected no other"))));
  EXPECT_THAT(errors("{type: simulated, transfer_system: {type: linear_servo_hydraulic, mass_kg: 0.0}}"),
              Contains(HasSubstr("mass_kg")));
}

TEST_F(RigsTest, LinearServoHydraulicGivesForceOfItsSpecimen) {
  const Scenario scenario = read("{type: simulated, transfer_system: {type: linear_servo_hydraulic}}");
  const std::unique_ptr<Rig> rig = scenario.substructures[0].make_rig(1e-3);
  rig->connect();
  rig->arm();
  ActuatorCommand command;
  command.displacement_m = SiteVector::Constant(1, 0.002);
  RigFeedback feedback{SiteVector::Zero(1), SiteVector::Zero(1)};
  for (int i = 0; i < 3000; ++i) ASSERT_EQ(rig->exchange(command, feedback), RigStatus::healthy);
  EXPECT_NEAR(feedback.force_n[0], 1.190e6 * feedback.displacement_m[0], 1e-3) << "at rest";
  EXPECT_GT(feedback.displacement_m[0], 0.0019);
}

TEST_F(RigsTest, RejectsControllerClockInLockstep) {
  EXPECT_THAT(errors("{type: udp, host: a, port: 1}"), Contains(HasSubstr("clock of its own")));
  EXPECT_THAT(errors("{type: udp, host: a, port: 1, pace: datagrams}"), IsEmpty());
}

TEST_F(RigsTest, RejectsRemoteRigInSimulatedTime) {
  const Scenario scenario = read("{type: udp, host: a, port: 1, pace: datagrams}");
  NoRecord nothing;
  const SimulationObserver observer{
      .sink = [&](const std::string&, const TableLayout&) -> RowSink& { return nothing; }};
  EXPECT_THROW(static_cast<void>(simulate(scenario, {}, observer)), ConfigError);
}

TEST_F(RigsTest, GeometryWrapsAnyRig) {
  const std::string two_specimens =
      "{type: simulated, transfer_system: {type: ideal}, specimen: [{type: elastic, stiffness_n_per_m: 1.0e6}, {type: "
      "elastic, stiffness_n_per_m: 2.0e6}], geometry: {type: linear, matrix: [[1.0], [2.0]]}}";
  const Scenario scenario = read(two_specimens);
  EXPECT_THAT(tables(scenario), ElementsAre("rig_actuators"));
  const auto rig = scenario.substructures[0].make_rig(0.001);
  rig->connect();
  rig->arm();
  ActuatorCommand command;
  command.displacement_m = SiteVector{{0.01}};
  RigFeedback feedback{SiteVector::Zero(1), SiteVector::Zero(1)};
  ASSERT_EQ(rig->exchange(command, feedback), RigStatus::healthy);
  EXPECT_DOUBLE_EQ(feedback.displacement_m[0], 0.01);
  EXPECT_DOUBLE_EQ(feedback.force_n[0], (1.0e6 + 2.0 * 2.0 * 2.0e6) * 0.01);
  EXPECT_THAT(tables(read("{type: udp, host: a, port: 1, pace: datagrams, geometry: {type: linear, matrix: [[2.0]], "
                          "actuator_limits: {stroke_m: 0.2}}}")),
              ElementsAre("rig_link", "rig_actuators"));
}

TEST_F(RigsTest, ReportsErrorsOfGeometry) {
  const auto of_geometry = [&](const std::string& geometry) {
    return errors("{type: udp, host: a, port: 1, pace: datagrams, geometry: " + geometry + "}");
  };
  EXPECT_THAT(of_geometry("{type: rigid_beam, attachment_m: [[0, 1], [0, -1]], anchor_m: [[-2, 1], [-2, -1]]}"),
              Contains(HasSubstr("2 interface degrees of freedom")));
  EXPECT_THAT(of_geometry("{type: linear, matrix: [[0.0]]}"),
              Contains(HasSubstr("does not determine every degree of freedom")));
  EXPECT_THAT(of_geometry("{type: liner, matrix: [[1.0]]}"), Contains(HasSubstr("linear")));
  EXPECT_THAT(of_geometry("{type: linear, matrix: [[1.0]], stroke_m: 1.0}"), Contains(HasSubstr("stroke_m")));
}

}  // namespace
}  // namespace hybridtest
