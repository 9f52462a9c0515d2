#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "core/config_error.hpp"
#include "scenario/catalogue/laws.hpp"
#include "tests/simulation/kept_simulation.hpp"

/// Every law of the catalogue as the specimen of a simulated rig, and as a numerical substructure.
namespace hybridtest {
namespace {

struct NamedLaw {
  std::string type;
  std::string keys;
  [[nodiscard]] std::string text() const { return "{type: " + type + ", " + keys + "}"; }
};

void PrintTo(const NamedLaw& law, std::ostream* stream) { *stream << law.type; }

const std::vector<NamedLaw>& laws_of_a_storey() {
  static const std::string yielding = "stiffness_n_per_m: 4.0e6, yield_force_n: 4.0e4, hardening_ratio: 0.05";
  static const std::vector<NamedLaw> laws{
      {"elastic", "stiffness_n_per_m: 4.0e6"},
      {"bilinear", yielding},
      {"giuffre_menegotto_pinto", yielding + ", a1: 0.02"},
      {"bouc_wen", "stiffness_n_per_m: 4.0e6, alpha: 0.1, gamma_per_m: 50.0, beta_per_m: 50.0"},
      {"bouc_wen_baber_noori", "stiffness_n_per_m: 4.0e6, alpha: 0.1, gamma_per_m: 50.0, beta_per_m: 50.0"},
      {"peak_oriented", yielding + ", strength_capacity_m: 3.0"},
      {"pinching", yielding + ", pinching_force_ratio: 0.3, pinching_displacement_ratio: 0.4"},
      {"takeda", yielding + ", cracking_force_n: 1.0e4, cracked_ratio: 0.7"},
      {"self_centring", "stiffness_n_per_m: 4.0e6, activation_force_n: 4.0e4, hardening_ratio: 0.1, flag_ratio: 0.8"},
      {"ramberg_osgood", "stiffness_n_per_m: 4.0e6, yield_force_n: 4.0e4"},
      {"friction_pendulum", "weight_n: 4.0e5, radius_m: 1.0, friction_coefficient: 0.05"},
      {"lead_rubber", "rubber_stiffness_n_per_m: 4.0e5, lead_strength_n: 2.0e4, yield_displacement_m: 0.01"},
      {"mr_damper",
       "damping_n_s_per_m: 2.0e4, hysteretic_force_n: 5.0e3, hysteretic_displacement_m: 0.002, "
       "stiffness_n_per_m: 4.0e6"},
      {"elastomer", "stiffness_n_per_m: 4.0e6, mullins_softening: 0.3, payne_force_n: 5.0e3"},
      {"friction", "friction_force_n: 5.0e3, presliding_displacement_m: 0.001"},
      {"gap", "stiffness_n_per_m: 4.0e6, gap_m: 0.001"},
      {"viscous", "damping_n_s_per_m: 2.0e4"},
      {"parallel", "laws: [{type: elastic, stiffness_n_per_m: 4.0e6}, {type: viscous, damping_n_s_per_m: 2.0e4}]"},
  };
  return laws;
}

TEST(LawsInATest, EveryLawOfTheCatalogueIsHere) {
  std::vector<std::string> types;
  for (const NamedLaw& law : laws_of_a_storey()) types.push_back(law.type);
  EXPECT_THAT(types, testing::UnorderedElementsAreArray(names_of(laws())));
}

class LawInATest : public testing::TestWithParam<NamedLaw> {
 protected:
  /// The largest value of a column of forces; the test has to complete.
  static double largest_force_n(const std::string& override_text, const std::string& table, const std::string& column) {
    const KeptSimulation run = keep_simulation(
        shipped_scenario("two_storey_one_site",
                         {"time={mode: lockstep, step_s: 0.001, duration_s: 4.0}", "structure.damping={type: none}",
                          "substructures[storey_1].limits={displacement_m: 0.5, velocity_m_per_s: 5.0, "
                          "force_n: 1.0e7}",
                          override_text}),
        {});
    EXPECT_EQ(run.result.coordinator.reason, StopReason::completed);
    double largest_n = 0.0;
    for (const double force_n : run.table(table == "steps" ? "coordinator" : "storey_1", table).column_values(column)) {
      EXPECT_TRUE(std::isfinite(force_n));
      largest_n = std::max(largest_n, std::abs(force_n));
    }
    return largest_n;
  }
};

TEST_P(LawInATest, IsTheSpecimenOfASimulatedRig) {
  EXPECT_GT(largest_force_n("substructures[storey_1].rig.specimen=" + GetParam().text(), "control", "measured_force_n"),
            1.0e3);
}

TEST_P(LawInATest, IsANumericalSubstructure) {
  EXPECT_GT(largest_force_n("substructures[storey_2].model=" + GetParam().text(), "steps", "restoring_force_floor_2_n"),
            1.0e3);
}

constexpr const char* kNearlyRigidFriction =
    "substructures[storey_2].model={type: springs, springs: ["
    "{at: floor_2_relative_to_floor_1, law: {type: elastic, stiffness_n_per_m: 3.0e6}}, "
    "{at: floor_2_relative_to_floor_1, law: {type: friction, friction_force_n: 1.0e4, "
    "presliding_displacement_m: 1.0e-8}}]}";

TEST(NearlyRigidLaw, IsRefusedByAnExplicitIntegrator) {
  EXPECT_THAT([] { static_cast<void>(shipped_scenario("two_storey_one_site", {kNearlyRigidFriction})); },
              testing::ThrowsMessage<ConfigError>(testing::HasSubstr("too long for an explicit integrator")));
}

TEST(NearlyRigidLaw, SticksAndSlidesWithoutAStepLimit) {
  const KeptSimulation run = keep_simulation(
      shipped_scenario("two_storey_one_site", {kNearlyRigidFriction, "integrator={type: cr}", "time.duration_s=10"}),
      {});
  ASSERT_EQ(run.result.coordinator.reason, StopReason::completed);
  const KeptRows& steps = run.table("storey_2", "steps");
  const std::vector<double> drift_m = steps.column_values("displacement_floor_2_relative_to_floor_1_m");
  const std::vector<double> force_n = steps.column_values("force_floor_2_relative_to_floor_1_n");
  double largest_drift_m = 0.0;
  for (std::size_t i = 0; i < drift_m.size(); ++i) {
    ASSERT_LE(std::abs(force_n[i] - 3.0e6 * drift_m[i]), 1.0e4 * (1.0 + 1e-9)) << "step " << i;
    largest_drift_m = std::max(largest_drift_m, std::abs(drift_m[i]));
  }
  EXPECT_GT(largest_drift_m, 1e-4) << "it slides";
}

INSTANTIATE_TEST_SUITE_P(Catalogue, LawInATest, testing::ValuesIn(laws_of_a_storey()),
                         [](const auto& instance) { return instance.param.type; });

}  // namespace
}  // namespace hybridtest
