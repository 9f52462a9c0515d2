#include <gtest/gtest.h>

#include "scenario/scenario.hpp"
#include "tests/unit/scenario/scenario_file.hpp"

namespace hybridtest {
namespace {

/// What a rig that stands still reads first: its noise.
double first_reading_n(const SubstructureScenario& site) {
  const auto rig = site.make_rig(0.001);
  rig->connect();
  RigFeedback feedback{.displacement_m = SiteVector::Zero(1), .force_n = SiteVector::Zero(1)};
  ActuatorCommand command;
  command.displacement_m = SiteVector::Zero(1);
  EXPECT_EQ(rig->exchange(command, feedback), RigStatus::healthy);
  return feedback.force_n[0];
}

TEST(SiteNoise, DiffersBetweenSitesForOneSeed) {
  const std::string second_site =
      "  - id: storey_2\n"
      "    kind: experimental\n"
      "    interface: [{dof: floor_2, relative_to: floor_1}]\n"
      "    initial_stiffness_n_per_m: [[3.0e6]]\n"
      "    rig:\n"
      "      type: simulated\n"
      "      transfer_system: {type: ideal}\n"
      "      specimen: {type: elastic, stiffness_n_per_m: 3.0e6}\n"
      "      sensors: {force_noise_n: 50.0, seed: 7}\n"
      "    limits: {displacement_m: 0.2, velocity_m_per_s: 1.5, force_n: 150.0e3}\n";
  const std::string whole = kScenarioText;
  const ScenarioFile file;
  const Scenario scenario = file.read(whole.substr(0, whole.find("  - id: storey_2")) + second_site);
  const double first_n = first_reading_n(*scenario.find("storey_1"));
  EXPECT_NE(first_n, 0.0);
  EXPECT_EQ(first_n, first_reading_n(*scenario.find("storey_1")));
  EXPECT_NE(first_n, first_reading_n(*scenario.find("storey_2")));
}

}  // namespace
}  // namespace hybridtest
