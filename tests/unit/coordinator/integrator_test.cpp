#include "coordinator/integrators/integrator.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/config_error.hpp"
#include "tests/support/integration_methods.hpp"
#include "tests/support/malloc_count.hpp"
#include "tests/support/structures.hpp"

namespace hybridtest {
namespace {

/// What every integrator promises.
class IntegratorTest : public ::testing::TestWithParam<test::IntegrationMethod> {
 protected:
  [[nodiscard]] static std::unique_ptr<Integrator> make(const LinearStructure& structure, double step_s,
                                                        const InitialMotion& initial = {}) {
    return GetParam().make(structure, step_s, initial);
  }
};
/// What those without the initial stiffness promise.
class ExplicitIntegratorTest : public IntegratorTest {};

const auto kName = [](const auto& method) { return method.param.name; };
INSTANTIATE_TEST_SUITE_P(All, IntegratorTest, testing::ValuesIn(test::all_methods()), kName);
INSTANTIATE_TEST_SUITE_P(All, ExplicitIntegratorTest, testing::ValuesIn(test::explicit_methods()), kName);

constexpr double kMass_kg = 2.0;
constexpr double kFrequency_rad_per_s = 7.0;
constexpr double kStiffness_n_per_m = kMass_kg * kFrequency_rad_per_s * kFrequency_rad_per_s;
const Eigen::VectorXd kNoLoad = Eigen::VectorXd::Zero(1);

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

auto spring(double stiffness_n_per_m) {
  return [stiffness_n_per_m](const MotionState& command) -> Eigen::VectorXd {
    return stiffness_n_per_m * command.displacement_m;
  };
}

TEST_P(IntegratorTest, StartsAtTheInitialMotion) {
  const auto integrator = make(test::oscillator(kMass_kg, 0.0, kStiffness_n_per_m), 0.01, {one(0.3), one(-0.2)});
  EXPECT_EQ(integrator->current().displacement_m[0], 0.3);
  EXPECT_EQ(integrator->current().velocity_m_per_s[0], -0.2);
  EXPECT_EQ(integrator->current().acceleration_m_per_s2[0], 0.0);
}

TEST_P(ExplicitIntegratorTest, VibratesFreelyAtTheFrequencyOfItsDifferenceEquation) {
  // Undamped, u_i = u_0 cos(i theta) with sin(theta/2) = omega dt/2, exactly.
  constexpr double kStep_s = 0.05;
  const auto integrator = make(test::oscillator(kMass_kg, 0.0, kStiffness_n_per_m), kStep_s, {one(1.0), one(0.0)});
  const double theta = 2.0 * std::asin(0.5 * kFrequency_rad_per_s * kStep_s);
  for (int step = 0; step < 2000; ++step) {
    // Rounding of one unit per step, so it grows at worst with the number of steps.
    ASSERT_NEAR(integrator->current().displacement_m[0], std::cos(step * theta), 1e-15 * (step + 1) * 10.0);
    integrator->advance(kStiffness_n_per_m * integrator->current().displacement_m, kNoLoad);
  }
}

/// Largest error of a damped free vibration from u_0 and v_0 over two seconds.
double free_vibration_error(const test::IntegrationMethod& method, double step_s) {
  constexpr double kRatio = 0.05;
  constexpr double kInitialDisplacement_m = 0.1;
  constexpr double kInitialVelocity_m_per_s = 0.4;
  const double damping = 2.0 * kRatio * kFrequency_rad_per_s * kMass_kg;
  const double damped = kFrequency_rad_per_s * std::sqrt(1.0 - kRatio * kRatio);
  const double decay = kRatio * kFrequency_rad_per_s;
  const auto integrator = method.make(test::oscillator(kMass_kg, damping, kStiffness_n_per_m), step_s,
                                      {one(kInitialDisplacement_m), one(kInitialVelocity_m_per_s)});
  double error = 0.0;
  const int steps = static_cast<int>(std::lround(2.0 / step_s));
  for (int step = 0; step <= steps; ++step) {
    const double time_s = step * step_s;
    const double exact = std::exp(-decay * time_s) * (kInitialDisplacement_m * std::cos(damped * time_s) +
                                                      (kInitialVelocity_m_per_s + decay * kInitialDisplacement_m) /
                                                          damped * std::sin(damped * time_s));
    complete_step(*integrator, spring(kStiffness_n_per_m), kNoLoad);
    error = std::max(error, std::abs(integrator->completed().displacement_m[0] - exact));
  }
  return error;
}

TEST_P(IntegratorTest, IsOfSecondOrder) {
  const double coarse = free_vibration_error(GetParam(), 0.002);
  const double fine = free_vibration_error(GetParam(), 0.001);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.02);  // the next term of the error is of relative size omega dt
}

TEST_P(ExplicitIntegratorTest, PeriodErrorIsThatOfItsDifferenceEquation) {
  // Period elongation: phase error (omega dt)^2/24 omega t, of an amplitude of about 0.1 m.
  EXPECT_LT(free_vibration_error(GetParam(), 0.004),
            0.12 * std::pow(kFrequency_rad_per_s * 0.004, 2) / 24.0 * kFrequency_rad_per_s * 2.0);
}

TEST_P(ExplicitIntegratorTest, IsStableUpToTheLimitAndNotBeyond) {
  const auto peak = [](double omega_dt) {
    const auto integrator = make(test::oscillator(kMass_kg, 0.0, kStiffness_n_per_m), omega_dt / kFrequency_rad_per_s,
                                 {one(1.0), one(0.0)});
    double largest = 0.0;
    for (int step = 0; step < 1000; ++step) {
      integrator->advance(kStiffness_n_per_m * integrator->current().displacement_m, kNoLoad);
      largest = std::max(largest, std::abs(integrator->current().displacement_m[0]));
    }
    return largest;
  };
  EXPECT_LT(peak(1.999), 1.0 + 1e-9);
  EXPECT_GT(peak(2.001), 1e6);
}

TEST_P(ExplicitIntegratorTest, DampingKeepsTheStabilityLimit) {
  // The difference equation's roots multiply to (1 - z)/(1 + z), z = ratio omega dt, and add to
  // (2 - (omega dt)^2)/(1 + z): one of them passes -1 at omega dt = 2 for any ratio.
  constexpr double kRatio = 0.5;
  const auto amplitude = [](double omega_dt) {
    const auto integrator =
        make(test::oscillator(kMass_kg, 2.0 * kRatio * kFrequency_rad_per_s * kMass_kg, kStiffness_n_per_m),
             omega_dt / kFrequency_rad_per_s, {one(1.0), one(0.0)});
    for (int step = 0; step < 10000; ++step) {
      integrator->advance(kStiffness_n_per_m * integrator->current().displacement_m, kNoLoad);
    }
    return std::abs(integrator->current().displacement_m[0]);
  };
  EXPECT_LT(amplitude(1.999), 1e-6);
  EXPECT_GT(amplitude(2.001), 1e6);
}

/// Full mass, full and by choice unsymmetric damping, full stiffness.
LinearStructure full_structure(bool has_symmetric_damping) {
  Random random{11};
  constexpr int kSize = 6;
  const Eigen::MatrixXd mass = test::random_definite_matrix(kSize, random);
  Eigen::MatrixXd damping = 0.5 * test::random_definite_matrix(kSize, random);
  if (!has_symmetric_damping) damping(0, kSize - 1) += 0.7;
  return test::structure_of(mass, damping, 200.0 * test::random_definite_matrix(kSize, random));
}

Eigen::VectorXd load(Eigen::Index size, int step) {
  return Eigen::VectorXd::LinSpaced(size, -1.0, 2.0) * std::sin(0.13 * step);
}

TEST_P(IntegratorTest, CompletedMotionIsInEquilibrium) {
  for (const bool has_symmetric_damping : {true, false}) {
    const LinearStructure structure = full_structure(has_symmetric_damping);
    const auto integrator =
        make(structure, 0.02, {Eigen::VectorXd::Constant(6, 0.1), Eigen::VectorXd::Constant(6, -1.0)});
    for (int step = 0; step < 200; ++step) {
      const Eigen::VectorXd applied = load(6, step);
      Eigen::VectorXd displacement;
      Eigen::VectorXd restoring;
      const auto force = [&](const MotionState& command) -> const Eigen::VectorXd& {
        displacement = command.displacement_m;
        return restoring = structure.initial_stiffness_n_per_m * displacement;
      };
      complete_step(*integrator, force, applied);
      const MotionState& completed = integrator->completed();
      const Eigen::VectorXd correction = completed.displacement_m - displacement;
      if (!GetParam().needs.corrects_displacement) {
        ASSERT_EQ(correction.norm(), 0.0);
      }
      const Eigen::VectorXd inertia = structure.mass_kg * completed.acceleration_m_per_s2;
      const Eigen::VectorXd residual = inertia + structure.damping_n_s_per_m * completed.velocity_m_per_s + restoring +
                                       structure.initial_stiffness_n_per_m * correction - applied;
      // Accelerations carry the rounding of displacements times 1/dt^2 = 2500.
      ASSERT_LT(residual.cwiseAbs().maxCoeff(), 1e-11 * (1.0 + inertia.cwiseAbs().maxCoeff())) << "step " << step;
    }
  }
}

TEST_P(IntegratorTest, StartsWithTheGivenVelocity) {
  const LinearStructure structure = full_structure(true);
  const Eigen::VectorXd velocity = Eigen::VectorXd::LinSpaced(6, -1.0, 1.0);
  const auto integrator = make(structure, 0.02, {Eigen::VectorXd::Zero(6), velocity});
  integrator->advance(Eigen::VectorXd::Zero(6), Eigen::VectorXd::Ones(6));
  EXPECT_LT((integrator->completed().velocity_m_per_s - velocity).cwiseAbs().maxCoeff(), 1e-13);
}

TEST_P(IntegratorTest, IsExactForConstantAcceleration) {
  constexpr double kStep_s = 0.25;  // powers of two, so that the parabola is exact in binary
  const auto integrator = make(test::oscillator(2.0, 0.0, 0.0), kStep_s);
  for (int step = 0; step < 40; ++step) {
    if (step > 0) {
      EXPECT_NEAR(integrator->current().velocity_m_per_s[0], 1.5 * step * kStep_s, 1e-13);
      EXPECT_NEAR(integrator->current().acceleration_m_per_s2[0], 1.5, 1e-13);
    }
    complete_step(*integrator, spring(0.0), one(3.0));
    if (step % GetParam().needs.commands_per_step != 0) continue;  // a command inside a step of the method
    EXPECT_NEAR(integrator->completed().displacement_m[0], 0.75 * std::pow(step * kStep_s, 2), 1e-12);
  }
}

TEST_P(ExplicitIntegratorTest, KeepsTheEnergyOfAnUndampedBuilding) {
  const LinearStructure building = test::shear_building(5, 1.0e4, 1.0e7);
  // E = v_half^T (M - dt^2/4 K) v_half / 2 + mean(u)^T K mean(u) / 2 with v_half = (u_{i+1} - u_i)/dt
  // and mean(u) between both is what the difference equation conserves.
  constexpr double kStep_s = 0.02;
  const auto integrator = make(building, kStep_s, {Eigen::VectorXd::LinSpaced(5, 0.0, 0.1), Eigen::VectorXd::Zero(5)});
  const Eigen::MatrixXd mass{building.mass_kg};
  const Eigen::MatrixXd stiffness{building.initial_stiffness_n_per_m};
  double first = 0.0;
  for (int step = 0; step < 5000; ++step) {
    const Eigen::VectorXd before = integrator->current().displacement_m;
    integrator->advance(stiffness * before, Eigen::VectorXd::Zero(5));
    const Eigen::VectorXd velocity = (integrator->current().displacement_m - before) / kStep_s;
    const Eigen::VectorXd mean = 0.5 * (integrator->current().displacement_m + before);
    const double energy =
        0.5 * velocity.dot((mass - 0.25 * kStep_s * kStep_s * stiffness) * velocity) + 0.5 * mean.dot(stiffness * mean);
    if (step == 0) first = energy;
    ASSERT_NEAR(energy / first, 1.0, 1e-11);
  }
}

TEST_P(IntegratorTest, DoesNotAllocateInAStep) {
  if (!counts_mallocs()) GTEST_SKIP() << "a sanitizer owns the allocator";
  for (const LinearStructure& structure :
       {test::two_storeys(), test::shear_building(100, 1.0, 1.0), full_structure(true), full_structure(false)}) {
    const auto integrator = make(structure, 0.001);
    const Eigen::VectorXd restoring = Eigen::VectorXd::Ones(structure.size());
    const Eigen::VectorXd applied = Eigen::VectorXd::Zero(structure.size());
    const std::size_t before = malloc_count();
    for (int step = 0; step < 5; ++step) integrator->advance(restoring, applied);
    EXPECT_EQ(malloc_count(), before);
  }
}

TEST_P(IntegratorTest, RejectsInvalidInput) {
  LinearStructure structure = test::two_storeys();
  EXPECT_THROW(static_cast<void>(make(structure, 0.0)), ConfigError);
  EXPECT_THROW(static_cast<void>(make(structure, -0.001)), ConfigError);
  EXPECT_THROW(static_cast<void>(make(structure, std::nan(""))), ConfigError);
  EXPECT_THROW(static_cast<void>(make(structure, 0.001, {one(0.0), {}})), ConfigError);
  EXPECT_NO_THROW(static_cast<void>(make(structure, 0.001)));
  structure.mass_kg.coeffRef(0, 0) = 0.0;
  EXPECT_THROW(static_cast<void>(make(structure, 0.001)), ConfigError);
}

TEST(CentralDifference, FollowsPublishedEquation) {
  // The formula in its usual form, with u_{i-1} instead of differences.
  const LinearStructure structure = full_structure(true);
  constexpr double kStep_s = 0.02;
  const Eigen::MatrixXd mass{structure.mass_kg};
  const Eigen::MatrixXd damping{structure.damping_n_s_per_m};
  const Eigen::MatrixXd stiffness{structure.initial_stiffness_n_per_m};
  const Eigen::MatrixXd inertia = mass / (kStep_s * kStep_s);
  const Eigen::MatrixXd effective = inertia + damping / (2.0 * kStep_s);
  Eigen::VectorXd now = Eigen::VectorXd::Constant(6, 0.1);
  const Eigen::VectorXd velocity = Eigen::VectorXd::Constant(6, -0.5);
  const Eigen::VectorXd start = mass.llt().solve(load(6, 0) - stiffness * now - damping * velocity);
  Eigen::VectorXd before = now - kStep_s * velocity + 0.5 * kStep_s * kStep_s * start;

  CentralDifference integrator{structure, kStep_s, {now, velocity}};
  for (int step = 0; step < 100; ++step) {
    ASSERT_LT((integrator.current().displacement_m - now).cwiseAbs().maxCoeff(), 1e-12) << "step " << step;
    const Eigen::VectorXd right_hand_side =
        2.0 * (inertia * now) + (damping / (2.0 * kStep_s) - inertia) * before - stiffness * now + load(6, step);
    before = now;
    now = effective.llt().solve(right_hand_side);
    integrator.advance(stiffness * integrator.current().displacement_m, load(6, step));
  }
}

TEST(ExplicitNewmark, EqualsCentralDifference) {
  for (const bool has_symmetric_damping : {true, false}) {
    const LinearStructure structure = full_structure(has_symmetric_damping);
    const InitialMotion initial{Eigen::VectorXd::Constant(6, 0.1), Eigen::VectorXd::Constant(6, -0.5)};
    CentralDifference central{structure, 0.02, initial};
    ExplicitNewmark newmark{structure, 0.02, initial};
    for (int step = 0; step < 500; ++step) {
      ASSERT_LT((central.current().displacement_m - newmark.current().displacement_m).cwiseAbs().maxCoeff(), 1e-12);
      central.advance(structure.initial_stiffness_n_per_m * central.current().displacement_m, load(6, step));
      newmark.advance(structure.initial_stiffness_n_per_m * newmark.current().displacement_m, load(6, step));
    }
  }
}

}  // namespace
}  // namespace hybridtest
