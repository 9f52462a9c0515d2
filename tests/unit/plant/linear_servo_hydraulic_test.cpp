#include "plant/transfer_systems/linear_servo_hydraulic.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "core/config_error.hpp"
#include "core/random.hpp"
#include "plant/specimens/specimen_in_transfer_system.hpp"
#include "tests/support/allocation_count.hpp"

namespace hybridtest {
namespace {

using Complex = std::complex<double>;

// As published, not as in the code.
constexpr double kGain = 1.0261, kA1b0 = 2.1283e13, kA2 = 4.2297e6, kA3 = 3.3, kBeta1 = 425.0, kBeta2 = 9.9976e4;
constexpr double kMass = 29.13, kDamping = 114.22, kStiffness = 1.190e6;

// Rates whose periods are whole nanoseconds.
Duration period_at(double rate_hz) { return from_seconds(1.0 / rate_hz); }

LinearServoHydraulic actuator_at(double rate_hz) { return {LinearServoHydraulic::Parameters{}, period_at(rate_hz)}; }

/// Of displacement and force to the command: the published equations, solved for x and F.
struct Response {
  Complex displacement;
  Complex force;
};

Response published_response(double omega) {
  const Complex s{0.0, omega};
  const Complex specimen = kMass * s * s + kDamping * s + kStiffness;
  const Complex valve = kA1b0 / (s * s + kBeta1 * s + kBeta2);
  const Complex displacement = valve * kGain / (specimen * (s + kA3) + kA2 * s + valve);
  return {displacement, specimen * displacement};
}

/// To a command that is held from sample to sample, at the samples: with the images of the hold.
Response sampled_response(double omega, double rate_hz) {
  Response sum;
  for (int image = -50; image <= 50; ++image) {
    const double at = omega + 2.0 * std::numbers::pi * rate_hz * image;
    const Complex angle{0.0, at / rate_hz};
    const Complex hold = (1.0 - std::exp(-angle)) / angle;
    const Response response = published_response(at);
    sum.displacement += hold * response.displacement;
    sum.force += hold * response.force;
  }
  return sum;
}

std::vector<double> random_commands(int count) {
  Random random{5, 0};
  std::vector<double> commands;
  double command_m = 0.0;
  for (int i = 0; i < count; ++i) commands.push_back(command_m = 0.99 * command_m + 2e-4 * random.normal());
  return commands;
}

using State = std::array<double, 5>;  // z, z', F, x, x'

State rate_of(const State& s, double command_m) {
  return {s[1], kA1b0 * (kGain * command_m - s[3]) - kBeta1 * s[1] - kBeta2 * s[0], s[0] - kA2 * s[4] - kA3 * s[2],
          s[4], (s[2] - kDamping * s[4] - kStiffness * s[3]) / kMass};
}

/// The benchmark's own way: classical Runge-Kutta.
State runge_kutta(const State& state, double command_m, double step_s) {
  const auto moved = [&](double by_s, const State& rate) {
    State to;
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = state[i] + by_s * rate[i];
    return to;
  };
  const State k1 = rate_of(state, command_m);
  const State k2 = rate_of(moved(0.5 * step_s, k1), command_m);
  const State k3 = rate_of(moved(0.5 * step_s, k2), command_m);
  const State k4 = rate_of(moved(step_s, k3), command_m);
  State to;
  for (std::size_t i = 0; i < to.size(); ++i)
    to[i] = state[i] + step_s / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
  return to;
}

TEST(LinearServoHydraulic, SineResponseIsThePublishedOne) {
  for (const double rate_hz : {1000.0, 4000.0}) {
    for (const double frequency_hz : {1.0, 4.0, 10.0, 40.0}) {
      LinearServoHydraulic actuator = actuator_at(rate_hz);
      const double omega = 2.0 * std::numbers::pi * frequency_hz;
      const int cycle = static_cast<int>(rate_hz / frequency_hz);
      const int settled = static_cast<int>(8.0 * frequency_hz) * cycle;
      const int measured = 4 * cycle;
      Complex displacement, force;
      for (int i = 0; i < settled + measured; ++i) {
        const double angle = omega * i / rate_hz;
        const double displacement_m = actuator.step(std::cos(angle));
        if (i < settled) continue;
        displacement += 2.0 / measured * displacement_m * std::polar(1.0, -angle);
        force += 2.0 / measured * actuator.specimen_force_n() * std::polar(1.0, -angle);
      }
      const Response wanted = sampled_response(omega, rate_hz);
      EXPECT_LT(std::abs(displacement / wanted.displacement - 1.0), 1e-8) << rate_hz << ", " << frequency_hz;
      EXPECT_LT(std::abs(force / wanted.force - 1.0), 1e-6) << rate_hz << ", " << frequency_hz;
    }
  }
}

TEST(LinearServoHydraulic, StepsAreTheExactDiscreteSolution) {
  // Of states of one size, so that the exponential loses no digits; the command is the last one.
  constexpr std::array<double, 6> kSize{1e8, 1e11, 1e6, 1.0, 1e2, 1.0};
  Eigen::Matrix<double, 6, 6> generator = Eigen::Matrix<double, 6, 6>::Zero();
  for (std::size_t column = 0; column < 6; ++column) {
    State unit{};
    if (column < 5) unit[column] = kSize[column];
    const State rate = rate_of(unit, column < 5 ? 0.0 : 1.0);
    for (std::size_t row = 0; row < 5; ++row) {
      generator(static_cast<int>(row), static_cast<int>(column)) = rate[row] / kSize[row];
    }
  }
  for (const double rate_hz : {1000.0, 2000.0, 4000.0}) {
    const Eigen::Matrix<double, 6, 6> transition = (generator / rate_hz).exp();
    LinearServoHydraulic actuator = actuator_at(rate_hz);
    Eigen::Vector<double, 6> state = Eigen::Vector<double, 6>::Zero();
    for (const double command_m : random_commands(2000)) {
      ASSERT_NEAR(actuator.step(command_m), state[3], 1e-15);
      ASSERT_NEAR(actuator.specimen_force_n(), kSize[2] * state[2], 1e-8);
      state[5] = command_m;
      state = (transition * state).eval();
    }
  }
}

TEST(LinearServoHydraulic, ResponseDoesNotDependOnThePeriod) {
  LinearServoHydraulic slow = actuator_at(1000.0);
  LinearServoHydraulic fast = actuator_at(4000.0);
  for (const double command_m : random_commands(1000)) {
    ASSERT_NEAR(slow.step(command_m), fast.step(command_m), 1e-13);
    for (int i = 0; i < 3; ++i) static_cast<void>(fast.step(command_m));
  }
}

TEST(LinearServoHydraulic, RungeKuttaTendsToItWithFourthOrder) {
  const auto largest_difference_m = [](int steps) {
    LinearServoHydraulic actuator = actuator_at(4000.0);
    State state{};
    double largest_m = 0.0;
    for (const double command_m : random_commands(4000)) {
      largest_m = std::max(largest_m, std::abs(actuator.step(command_m) - state[3]));
      for (int i = 0; i < steps; ++i) state = runge_kutta(state, command_m, 1.0 / 4000.0 / steps);
    }
    return largest_m;
  };
  const double as_published_m = largest_difference_m(1);
  EXPECT_LT(as_published_m, 2e-8);  // of some millimetres
  EXPECT_NEAR(std::log2(as_published_m / largest_difference_m(2)), 4.0, 0.2);
}

TEST(LinearServoHydraulic, HoldsTheCommandOfTheSampleBefore) {
  LinearServoHydraulic actuator = actuator_at(4000.0);
  EXPECT_EQ(actuator.step(0.01), 0.0);
  EXPECT_GT(actuator.step(0.01), 0.0);
}

TEST(LinearServoHydraulic, ConverterCutsAndRoundsCommands) {
  const auto settled_m = [](double command_m, double range_m, double step_m) {
    LinearServoHydraulic actuator{{.model = {}, .converter_range_m = range_m, .converter_step_m = step_m},
                                  period_at(1000.0)};
    for (int i = 0; i < 4000; ++i) static_cast<void>(actuator.step(command_m));
    return actuator.step(command_m);
  };
  const double per_command = settled_m(1.0, 0.0, 0.0);
  EXPECT_NEAR(settled_m(5.0, 3.8, 0.0), 3.8 * per_command, 1e-9);
  EXPECT_NEAR(settled_m(-5.0, 3.8, 0.0), -3.8 * per_command, 1e-9);
  EXPECT_NEAR(settled_m(0.0149, 0.0, 0.01), 0.01 * per_command, 1e-9);
  EXPECT_NEAR(settled_m(0.0151, 0.0, 0.01), 0.02 * per_command, 1e-9);
}

TEST(LinearServoHydraulic, ResetGoesBackToRest) {
  LinearServoHydraulic actuator = actuator_at(4000.0);
  for (const double command_m : random_commands(50)) static_cast<void>(actuator.step(command_m));
  actuator.reset();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(actuator.step(0.0), 0.0);
  EXPECT_EQ(actuator.specimen_force_n(), 0.0);
}

TEST(LinearServoHydraulic, RefusesParametersOutOfRange) {
  LinearServoHydraulic::Parameters parameters;
  parameters.model.mass_kg = 0.0;
  EXPECT_THROW((LinearServoHydraulic{parameters, period_at(1000.0)}), ConfigError);
  parameters = {};
  parameters.converter_step_m = -1e-6;
  EXPECT_THROW((LinearServoHydraulic{parameters, period_at(1000.0)}), ConfigError);
  EXPECT_THROW((LinearServoHydraulic{{}, Duration::zero()}), ConfigError);
}

TEST(SpecimenInTransferSystem, ForceIsThatOfEachTransferSystem) {
  LinearServoHydraulic first = actuator_at(1000.0);
  LinearServoHydraulic second = actuator_at(1000.0);
  SpecimenInTransferSystem specimen{{&first, &second}};
  ASSERT_EQ(specimen.dofs(), 2);
  for (int i = 0; i < 100; ++i) {
    static_cast<void>(first.step(0.001));
    static_cast<void>(second.step(-0.002));
  }
  SiteVector force_n = SiteVector::Zero(2);
  specimen.impose(SiteVector::Zero(2), SiteVector::Zero(2), force_n);
  EXPECT_EQ(force_n[0], first.specimen_force_n());
  EXPECT_NEAR(force_n[1], -2.0 * force_n[0], 1e-9);
  EXPECT_GT(force_n[0], 100.0);
}

TEST(LinearServoHydraulic, StepAllocatesNothing) {
  LinearServoHydraulic actuator = actuator_at(4000.0);
  const std::size_t before = allocation_count();
  for (int i = 0; i < 100; ++i) static_cast<void>(actuator.step(0.001));
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace hybridtest
