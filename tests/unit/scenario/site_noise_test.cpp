#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/random.hpp"
#include "plant/site_model.hpp"
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

TEST(SiteNoise, ColouredNoiseIsReadWithItsTime) {
  const ScenarioFile file;
  const std::string sensors = "substructures[storey_1].rig.sensors=";
  const auto reading_n = [&](const std::string& noise) {
    return first_reading_n(*file.read(kScenarioText, {sensors + noise}).find("storey_1"));
  };
  const double white_n = reading_n("{force_noise_n: 50.0, seed: 7}");
  const double both_n =
      reading_n("{force_noise_n: 50.0, seed: 7, force_coloured_noise_n: 20.0, force_correlation_time_s: 0.01}");
  Random coloured{7, SensorNoise::kToColouredStreams + 1};
  EXPECT_NEAR(both_n - white_n, 20.0 * coloured.normal(), 1e-9);
  for (const char* half : {"{force_coloured_noise_n: 20.0}", "{force_correlation_time_s: 0.01}",
                           "{force_coloured_noise_n: 20.0, force_correlation_time_s: 0.0}",
                           "{displacement_coloured_noise_m: -1.0e-6, displacement_correlation_time_s: 0.01}"}) {
    EXPECT_THAT(file.errors(kScenarioText, {sensors + half}), testing::Not(testing::IsEmpty())) << half;
  }
}

TEST(SiteNoise, WithoutColouredNoiseTheScenarioIsTheSame) {
  const ScenarioFile file;
  EXPECT_EQ(file.read(kScenarioText).effective.find("coloured"), std::string::npos);
}

}  // namespace
}  // namespace hybridtest
