#include "mechanics/structure/energy_balance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hybridtest {
namespace {

constexpr double kMass_kg = 1000.0;
constexpr double kStiffness_n_per_m = 40.0e3;
constexpr double kDamping_n_s_per_m = 600.0;
constexpr double kAmplitude_m = 0.03;
constexpr double kOmega = 5.0;

Eigen::SparseMatrix<double> matrix(double value) {
  Eigen::SparseMatrix<double> result{1, 1};
  result.insert(0, 0) = value;
  return result;
}

Eigen::VectorXd vector(double value) { return Eigen::VectorXd::Constant(1, value); }

/// Steady motion A sin(w t) of one degree of freedom over some time; the force that keeps it up is the load.
/// @param felt   share of the restoring force that is recorded.
StructureEnergy steady_motion(double step_s, double until_s, double felt = 1.0) {
  EnergyBalance balance{matrix(kMass_kg), matrix(kDamping_n_s_per_m)};
  const auto steps = static_cast<int>(std::lround(until_s / step_s));
  for (int i = 0; i <= steps; ++i) {
    const double phase = kOmega * step_s * i;
    const double displacement_m = kAmplitude_m * std::sin(phase);
    const double velocity_m_per_s = kAmplitude_m * kOmega * std::cos(phase);
    const double restoring_n = kStiffness_n_per_m * displacement_m;
    const double inertia_n = -kMass_kg * kOmega * kOmega * displacement_m;
    balance.add(vector(displacement_m), vector(velocity_m_per_s), vector(felt * restoring_n),
                vector(inertia_n + kDamping_n_s_per_m * velocity_m_per_s + restoring_n));
  }
  return balance.energy();
}

// Ten cycles and a quarter: at rest in the largest displacement. Chopra, Dynamics of Structures, sections 3.8 and 7.9.
const double kUntil_s = 10.25 * 2.0 * std::numbers::pi / kOmega;

TEST(EnergyBalance, SteadyMotionHasTheEnergiesOfTheClosedForm) {
  const StructureEnergy energy = steady_motion(kUntil_s / 41000.0, kUntil_s);
  const double strain_j = 0.5 * kStiffness_n_per_m * kAmplitude_m * kAmplitude_m;
  // Viscous damping takes pi c w A^2 in a cycle.
  const double damping_j = 10.25 * std::numbers::pi * kDamping_n_s_per_m * kOmega * kAmplitude_m * kAmplitude_m;
  // A thousand steps in a quarter of a cycle: the trapezoidal rule misses about (pi / 2000)^2 / 12 = 2e-7.
  EXPECT_NEAR(energy.kinetic_j, 0.0, 1e-9 * strain_j);
  EXPECT_NEAR(energy.restoring_j, strain_j, 1e-6 * strain_j);
  EXPECT_NEAR(energy.damping_j, damping_j, 1e-6 * damping_j);
  EXPECT_NEAR(energy.error_j(), 0.0, 1e-6 * energy.input_j);
}

TEST(EnergyBalance, ErrorFallsWithTheSquareOfTheStep) {
  // Work of a force that follows the displacement is exact for any step; that of the damping is not.
  const double exact_j = 10.25 * std::numbers::pi * kDamping_n_s_per_m * kOmega * kAmplitude_m * kAmplitude_m;
  const double coarse_j = steady_motion(kUntil_s / 410.0, kUntil_s).damping_j - exact_j;
  const double fine_j = steady_motion(kUntil_s / 820.0, kUntil_s).damping_j - exact_j;
  EXPECT_GT(std::fabs(coarse_j), 1e-4 * exact_j);
  EXPECT_NEAR(coarse_j / fine_j, 4.0, 0.05);
}

TEST(EnergyBalance, ControlForceNotRecordedAsFeltIsTheError) {
  const double strain_j = 0.5 * kStiffness_n_per_m * kAmplitude_m * kAmplitude_m;
  EXPECT_NEAR(steady_motion(kUntil_s / 41000.0, kUntil_s, 0.9).error_j(), -0.1 * strain_j, 1e-3 * strain_j);
}

TEST(EnergyBalance, MotionAtTheStartIsInput) {
  EnergyBalance balance{matrix(kMass_kg), matrix(0.0)};
  balance.add(vector(0.0), vector(2.0), vector(0.0), vector(0.0));
  EXPECT_EQ(balance.energy().input_j, 2000.0);
  EXPECT_EQ(balance.energy().error_j(), 0.0);
}

}  // namespace
}  // namespace hybridtest
