#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "coordinator/integrators/implicit_newmark.hpp"
#include "core/config_error.hpp"
#include "mechanics/laws/bilinear.hpp"
#include "scenario/test_stability.hpp"
#include "tests/simulation/kept_simulation.hpp"

/// The shipped two-storey test with a second storey so stiff that omega dt of its mode is 3.2: beyond every explicit
/// integrator, and as it must be with the others.
namespace hybridtest {
namespace {

constexpr double kStiffStorey_n_per_m = 1.0e11;
constexpr Bilinear::Parameters kColumns{.stiffness_n_per_m = 4.0e6, .yield_force_n = 40.0e3, .hardening_ratio = 0.05};

Scenario with_fast_mode(const std::string& integrator, double step_s) {
  const std::string site = "substructures[storey_1].";
  return shipped_scenario("two_storey_one_site",
                          {"integrator=" + integrator, "time.step_s=" + std::to_string(step_s), "time.duration_s=12",
                           "substructures[storey_2].model.stiffness_n_per_m=" + std::to_string(kStiffStorey_n_per_m),
                           site + "rig.transfer_system={type: ideal}", site + "rig.sensors={}",
                           site + "compensator={type: none}", site + "control_rate_hz=1000"});
}

std::vector<double> top_floor_m(const std::string& integrator, double step_s) {
  const KeptSimulation kept = keep_simulation(with_fast_mode(integrator, step_s), SimulationSettings{});
  EXPECT_EQ(kept.result.coordinator.reason, StopReason::completed) << kept.log();
  return kept.table("coordinator", "steps").column_values("displacement_floor_2_m");
}

/// Our own reference: implicit, with a tenth of the step.
std::vector<double> reference_m() {
  constexpr double kStep_s = 1e-4;
  const Scenario scenario = with_fast_mode("{type: cr}", kStep_s);
  const Eigen::VectorXd load_kg = scenario.structure.load_per_ground_acceleration_kg();
  const std::vector<double>& ground_m_per_s2 = scenario.excitation.records.front().acceleration_m_per_s2;
  Bilinear columns{kColumns};
  const auto force_n = [&](const MotionState& command) -> Eigen::VectorXd {
    const Eigen::VectorXd& u = command.displacement_m;
    const double upper = kStiffStorey_n_per_m * (u[1] - u[0]);
    return Eigen::Vector2d{columns.trial(u[0], 0.0) - upper, upper};
  };
  ImplicitNewmark method{{.tolerance_m = 1e-12}, scenario.structure, kStep_s};
  std::vector<double> found;
  for (std::size_t step = 0; step < ground_m_per_s2.size(); ++step) {
    complete_step(method, force_n, load_kg * ground_m_per_s2[step]);
    EXPECT_EQ(method.missing_m(), 0.0);
    columns.commit();
    if (step % 10 == 0) found.push_back(method.completed().displacement_m[1]);
  }
  return found;
}

/// @param found   with a step that is this multiple of 0.001 s.
double share_of_peak(const std::vector<double>& found, const std::vector<double>& reference, std::size_t multiple) {
  double error_m = 0.0;
  double peak_m = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    error_m = std::max(error_m, std::abs(found[i] - reference.at(multiple * i)));
    peak_m = std::max(peak_m, std::abs(reference[multiple * i]));
  }
  return error_m / peak_m;
}

TEST(FastMode, RunsAndAgreesWithItsReference) {
  const std::vector<double> reference = reference_m();
  for (const std::string integrator : {"{type: cr}", "{type: kr_alpha}", "{type: alpha_operator_splitting}"}) {
    const double fine = share_of_peak(top_floor_m(integrator, 0.001), reference, 1);
    const double coarse = share_of_peak(top_floor_m(integrator, 0.002), reference, 2);
    RecordProperty("share_at_1_ms" + integrator, std::to_string(fine));
    RecordProperty("share_at_2_ms" + integrator, std::to_string(coarse));
    EXPECT_LT(fine, 1e-4) << integrator;  // measured 0.46e-4 to 0.60e-4
    EXPECT_GT(coarse / fine, 2.5) << integrator << ": of second order, but for the corners of the yielding";
    EXPECT_LT(coarse, 4e-4) << integrator;
  }
}

TEST(FastMode, IsRefusedWithExplicitIntegrator) {
  for (const char* integrator : {"{type: central_difference}", "{type: explicit_newmark}"}) {
    EXPECT_THAT([&] { static_cast<void>(with_fast_mode(integrator, 0.001)); },
                testing::ThrowsMessage<ConfigError>(testing::HasSubstr("too long for an explicit integrator")));
  }
}

TEST(FastMode, PreflightKnowsThatTheModeIsBeyondTheStep) {
  const auto stability = [](double step_s) {
    const Scenario scenario = with_fast_mode("{type: cr}", step_s);
    return test_stability(scenario, vibration_modes(scenario.structure));
  };
  EXPECT_TRUE(stability(0.001).has_modes_beyond_step);
  EXPECT_FALSE(stability(0.001).is_unstable(0.001));
  EXPECT_FALSE(stability(0.0005).has_modes_beyond_step);
}

}  // namespace
}  // namespace hybridtest
