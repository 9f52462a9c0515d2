#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>

#include "coordinator/preflight/coupled_loop.hpp"
#include "tests/support/amplification.hpp"
#include "tests/support/integration_methods.hpp"
#include "tests/support/spring_answer.hpp"

/// The integrators with the initial stiffness in their matrices, against the implicit methods whose roots they have.
namespace hybridtest {
namespace {

using Complex = std::complex<double>;
using test::IntegrationMethod;
using test::MeasuredMode;

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

double radius(const IntegrationMethod& method, const MeasuredMode& mode) {
  return test::spectral_radius(method.make, method.needs.commands_per_step, mode);
}

/// The largest root of the generalised-alpha method (Chung and Hulbert, 1993; with alpha_m = 0 the HHT-alpha method),
/// from its implicit equations for the state (u, dt v, dt^2 a) of a mode with m = 1.
struct ImplicitMethod {
  double alpha_m;
  double alpha_f;
  double gamma;
  double beta;

  [[nodiscard]] Eigen::Matrix3d amplification(const MeasuredMode& mode) const {
    const double stiffness = mode.omega_dt * mode.omega_dt;
    const double damping = 2.0 * mode.damping_ratio * mode.omega_dt;
    // (1 - am) a' + am a + c [(1 - af) v' + af v] + k [(1 - af) u' + af u] = 0 and Newmark's u' and v'.
    Eigen::Matrix3d next;
    next << 1.0, 0.0, -beta, 0.0, 1.0, -gamma, (1.0 - alpha_f) * stiffness, (1.0 - alpha_f) * damping, 1.0 - alpha_m;
    Eigen::Matrix3d now;
    now << 1.0, 1.0, 0.5 - beta, 0.0, 1.0, 1.0 - gamma, -alpha_f * stiffness, -alpha_f * damping, -alpha_m;
    return next.inverse() * now;
  }
  [[nodiscard]] Eigen::VectorXcd roots(const MeasuredMode& mode) const { return test::roots_of(amplification(mode)); }
};

ImplicitMethod generalised_alpha(double rho_inf) {
  const double alpha_m = (2.0 * rho_inf - 1.0) / (1.0 + rho_inf);
  const double alpha_f = rho_inf / (1.0 + rho_inf);
  const double gamma = 0.5 - alpha_m + alpha_f;
  return {alpha_m, alpha_f, gamma, 0.25 * std::pow(0.5 + gamma, 2)};
}

ImplicitMethod hht_alpha(double alpha) { return {0.0, -alpha, 0.5 - alpha, 0.25 * std::pow(1.0 - alpha, 2)}; }

void expect_roots(const IntegrationMethod& method, const ImplicitMethod& implicit) {
  for (const double ratio : {0.0, 0.05, 0.5}) {
    for (const double omega_dt : {0.2, 0.5, 1.0, 2.0, 3.0, 10.0, 100.0}) {
      const MeasuredMode mode{.omega_dt = omega_dt, .damping_ratio = ratio};
      const Eigen::VectorXcd expected = implicit.roots(mode);
      const Eigen::VectorXcd found = test::amplification_roots(method.make, 1, mode);
      // Roots that nearly coincide move by a root of the rounding.
      const double tolerance = omega_dt > 5.0 ? 2e-3 : 1e-6;
      EXPECT_NEAR(std::abs(found[0]), std::abs(expected[0]), tolerance) << method.name << ' ' << mode.omega_dt;
      if (std::abs(expected[0].imag()) > 0.1) {
        EXPECT_NEAR(std::abs(test::principal_root(found) - test::principal_root(expected)), 0.0, tolerance)
            << method.name << ' ' << mode.omega_dt << ' ' << ratio;
      }
    }
  }
}

TEST(KrAlpha, HasTheRootsOfGeneralisedAlpha) {
  for (const double rho_inf : {0.0, 0.5, 0.8}) expect_roots(test::kr_alpha(rho_inf), generalised_alpha(rho_inf));
  expect_roots(test::cr(), hht_alpha(0.0));  // without the third root at -1, which nothing excites
}

TEST(GeneralisedAlpha, HasTheRootsOfItsMethod) {
  for (const int iterations : {2, 5}) {
    for (const double rho_inf : {0.0, 0.5, 0.8}) {
      for (const double ratio : {0.0, 0.05}) {
        for (const double omega_dt : {0.1, 0.5, 2.0, 10.0}) {
          const MeasuredMode mode{.omega_dt = omega_dt, .damping_ratio = ratio};
          const MeasuredMode of_method{.omega_dt = iterations * omega_dt, .damping_ratio = ratio};
          EXPECT_NEAR(radius(test::generalised_alpha(rho_inf, iterations), mode),
                      std::abs(generalised_alpha(rho_inf).roots(of_method)[0]), 2e-3)
              << rho_inf << ' ' << iterations << ' ' << omega_dt;
        }
      }
    }
  }
}

TEST(GeneralisedAlpha, LastCommandMeetsTheEndOfTheStep) {
  // Constant load: with every iteration the command comes closer to the displacement that the step ends with.
  const auto correction = [](int iterations) {
    const auto method =
        test::generalised_alpha(0.8, iterations).make(test::oscillator(1.0, 0.1, 1.0), 1.0 / iterations, {});
    double largest = 0.0;
    for (int step = 0; step <= 20 * iterations; ++step) {
      const double command = method->current().displacement_m[0];
      method->advance(one(0.6 * command + 0.2 * std::tanh(command)), one(1.0));
      largest = std::max(largest, std::abs(method->completed().displacement_m[0] - command));
    }
    return largest;
  };
  EXPECT_GT(correction(2), 0.01);
  EXPECT_LT(correction(6), 0.5 * correction(2));
}

TEST(AlphaOperatorSplitting, HasTheRootsOfHhtAlpha) {
  for (const double alpha : {0.0, -0.1, -0.2, -1.0 / 3.0}) {
    expect_roots(test::operator_splitting(alpha), hht_alpha(alpha));
  }
}

TEST(ImplicitNewmark, HasTheRootsOfItsFormula) {
  expect_roots(test::implicit_newmark(), hht_alpha(0.0));
  for (const double gamma : {0.6, 0.8}) {
    const double beta = 0.25 * (gamma + 0.5) * (gamma + 0.5);
    expect_roots(test::method<ImplicitNewmark>("implicit_newmark_damped", {.gamma = gamma, .beta = beta}),
                 {0.0, 0.0, gamma, beta});
  }
}

TEST(KrAlpha, RhoInfIsTheRadiusOfInfinitelyFastModes) {
  for (const double rho_inf : {0.3, 0.5, 0.8, 1.0}) {
    EXPECT_NEAR(radius(test::kr_alpha(rho_inf), {.omega_dt = 1e4}), rho_inf, 3e-3);
  }
}

TEST(AlphaOperatorSplitting, FastModesKeepTheShareOfItsDocumentation) {
  for (const double alpha : {0.0, -0.1, -0.2}) {
    EXPECT_NEAR(radius(test::operator_splitting(alpha), {.omega_dt = 300.0}), (1.0 + alpha) / (1.0 - alpha), 5e-3);
  }
}

TEST(RosenbrockW, HasTheRootsOfItsStabilityFunction) {
  // R(z) = (1 + (1 - 2g) z + (1/2 - 2g + g^2) z^2)/(1 - g z)^2; the last term is zero.
  const double g = 1.0 - std::sqrt(0.5);
  for (const double ratio : {0.0, 0.05, 0.5}) {
    for (const double omega_dt : {0.1, 0.5, 1.0, 5.0, 50.0, 500.0}) {
      const Complex z = 2.0 * omega_dt * Complex{-ratio, std::sqrt(1.0 - ratio * ratio)};
      const Complex expected = (1.0 + (1.0 - 2.0 * g) * z) / ((1.0 - g * z) * (1.0 - g * z));
      const auto roots =
          test::amplification_roots(test::rosenbrock_w().make, 2, {.omega_dt = omega_dt, .damping_ratio = ratio});
      EXPECT_NEAR(std::abs(roots[0]), std::abs(expected), 1e-6) << omega_dt;
    }
  }
}

TEST(Cr, PeriodIsThatOfAverageAcceleration) {
  for (const double omega_dt : {0.1, 0.5, 1.0, 3.0}) {
    const auto roots = test::amplification_roots(test::cr().make, 1, {.omega_dt = omega_dt});
    EXPECT_NEAR(std::abs(roots[0]), 1.0, 1e-10);
    EXPECT_NEAR(std::arg(test::principal_root(roots)), 2.0 * std::atan(0.5 * omega_dt), 1e-9);
  }
}

class InitialStiffnessTest : public ::testing::TestWithParam<IntegrationMethod> {};
INSTANTIATE_TEST_SUITE_P(All, InitialStiffnessTest, testing::ValuesIn(test::methods_with_initial_stiffness()),
                         [](const auto& method) { return method.param.name; });

constexpr double kRounding = 1e-6;  // of a measured root

TEST_P(InitialStiffnessTest, IsStableWithAnyStep) {
  for (const double ratio : {0.0, 0.02, 0.3}) {
    for (const double omega_dt : {0.01, 0.1, 0.5, 1.0, 1.9, 2.1, 5.0, 20.0, 100.0, 1000.0}) {
      EXPECT_LT(radius(GetParam(), {.omega_dt = omega_dt, .damping_ratio = ratio}), 1.0 + kRounding) << omega_dt;
    }
  }
}

TEST_P(InitialStiffnessTest, StaysStableWhereTheStiffnessSoftens) {
  const LinearStructure structure = test::oscillator(1.0, 0.0, 1.0);
  for (const double omega_dt : {0.1, 1.0, 2.1, 5.0, 20.0}) {
    for (const double share : {0.001, 0.3, 0.7, 0.95}) {
      CoupledLoop loop{StructureResponse{structure,
                                         vibration_modes(structure),
                                         {InterfaceMap{1, {{0}}}},
                                         GetParam().make,
                                         omega_dt,
                                         GetParam().needs.commands_per_step},
                       {test::spring_answer(test::one_by_one(1.0), test::one_by_one(share))}};
      EXPECT_EQ(loop.growing_motions({0.0}), 0)
          << "omega dt " << omega_dt << ", stiffness " << share << " of the initial one";
    }
  }
}

/// Stiffness ratio at which omega dt of the excess is `excess`.
double ratio_for(double omega_dt, double excess) { return 1.0 + std::pow(excess / omega_dt, 2); }

TEST(InitialStiffnessMethods, ExcessIsStableUpToTwoWithoutDissipation) {
  for (const IntegrationMethod& method : {test::cr(), test::operator_splitting(0.0)}) {
    for (const double omega_dt : {0.1, 0.5, 1.0, 2.1, 5.0, 20.0}) {
      for (const double excess : {0.2, 1.0, 1.9, 1.999}) {
        EXPECT_LT(radius(method, {.omega_dt = omega_dt, .stiffness_ratio = ratio_for(omega_dt, excess)}),
                  1.0 + kRounding);
      }
      if (omega_dt > 10.0) continue;
      EXPECT_GT(radius(method, {.omega_dt = omega_dt, .stiffness_ratio = ratio_for(omega_dt, 2.02)}), 1.001);
    }
  }
}

TEST(InitialStiffnessMethods, ExcessIsNegativeDampingWhereOthersDamp) {
  for (const IntegrationMethod& method : {test::kr_alpha(0.8), test::operator_splitting(-0.1)}) {
    const MeasuredMode mode{.omega_dt = 0.5, .stiffness_ratio = ratio_for(0.5, 1.2)};
    EXPECT_GT(radius(method, mode), 1.003) << method.name;
    EXPECT_LT(radius(method, {.omega_dt = 0.5, .stiffness_ratio = ratio_for(0.5, 0.02)}), 1.0 + 1e-5) << method.name;
  }
}

TEST(Cr, FollowsPublishedEquations) {
  // With alpha_1 as a dense matrix; the velocity is half a step late, so it starts half a step earlier.
  Random random{11};
  const Eigen::MatrixXd mass = test::random_definite_matrix(6, random);
  const Eigen::MatrixXd damping = 0.5 * test::random_definite_matrix(6, random);
  const Eigen::MatrixXd stiffness = 2e4 * test::random_definite_matrix(6, random);
  const LinearStructure structure = test::structure_of(mass, damping, stiffness);
  constexpr double kStep_s = 0.02;
  const Eigen::MatrixXd alpha =
      4.0 * (4.0 * mass + 2.0 * kStep_s * damping + kStep_s * kStep_s * stiffness).ldlt().solve(mass);
  const Eigen::VectorXd start = Eigen::VectorXd::LinSpaced(6, -0.1, 0.2);
  const auto load = [](int step) -> Eigen::VectorXd {
    return Eigen::VectorXd::LinSpaced(6, 1.0, 2.0) * std::cos(0.1 * step);
  };
  const auto cr = test::cr().make(structure, kStep_s, {start, {}});
  Eigen::VectorXd u = start;
  Eigen::VectorXd velocity =
      -0.5 * kStep_s * (alpha * mass.llt().solve(load(0) - stiffness * start));  // V_0 = v_0 - dt/2 w_0
  for (int step = 0; step < 300; ++step) {
    ASSERT_LT((cr->current().displacement_m - u).cwiseAbs().maxCoeff(), 1e-11) << "step " << step;
    const Eigen::VectorXd force = step == 0 ? Eigen::VectorXd{load(0) - stiffness * u}
                                            : Eigen::VectorXd{load(step) - stiffness * u - damping * velocity};
    const Eigen::VectorXd weighted = alpha * mass.llt().solve(force);
    u += kStep_s * velocity + kStep_s * kStep_s * weighted;
    velocity += kStep_s * weighted;
    cr->advance(structure.initial_stiffness_n_per_m * cr->current().displacement_m, load(step));
  }
}

TEST(Cr, PublishedStartWouldBeOfFirstOrder) {
  // V_0 = v_0 is what a start with the velocity v_0 + dt/2 w_0 gives here.
  const auto error = [](double step_s, double shift) {
    const double weighted = -1.0 / (1.0 + 0.25 * step_s * step_s);
    const auto cr =
        test::cr().make(test::oscillator(1.0, 0.0, 1.0), step_s, {one(1.0), one(shift * step_s * weighted)});
    double largest = 0.0;
    for (int step = 0; step * step_s < 6.0; ++step) {
      largest = std::max(largest, std::abs(cr->current().displacement_m[0] - std::cos(step * step_s)));
      cr->advance(cr->current().displacement_m, one(0.0));
    }
    return largest;
  };
  EXPECT_NEAR(std::log2(error(0.02, 0.5) / error(0.01, 0.5)), 1.0, 0.05);
  EXPECT_NEAR(std::log2(error(0.02, 0.0) / error(0.01, 0.0)), 2.0, 0.05);
}

TEST(KrAlpha, FollowsPublishedEquations) {
  // With alpha_1 to alpha_3 as dense matrices.
  Random random{5};
  constexpr int kSize = 5;
  const Eigen::MatrixXd mass = test::random_definite_matrix(kSize, random);
  const Eigen::MatrixXd damping = 0.5 * test::random_definite_matrix(kSize, random);
  const Eigen::MatrixXd stiffness = 1e4 * test::random_definite_matrix(kSize, random);
  constexpr double kStep_s = 0.02;
  for (const double rho_inf : {0.0, 0.6, 0.95}) {
    const ImplicitMethod with = generalised_alpha(rho_inf);
    const Eigen::MatrixXd rest = with.gamma * kStep_s * damping + with.beta * kStep_s * kStep_s * stiffness;
    const Eigen::LDLT<Eigen::MatrixXd> whole{mass + rest};
    const Eigen::MatrixXd alpha_1 = whole.solve(mass);
    const Eigen::MatrixXd alpha_3 = whole.solve(with.alpha_m * mass + with.alpha_f * rest);
    const Eigen::MatrixXd inertia = mass * (Eigen::MatrixXd::Identity(kSize, kSize) - alpha_3);
    // At rest until the load acts from the second step on: there the start is as published.
    const auto load = [](int step) -> Eigen::VectorXd {
      return Eigen::VectorXd::LinSpaced(kSize, 1.0, 2.0) * std::sin(0.1 * std::max(0, step - 1));
    };
    const auto method = test::kr_alpha(rho_inf).make(test::structure_of(mass, damping, stiffness), kStep_s, {});
    Eigen::VectorXd u = Eigen::VectorXd::Zero(kSize);
    Eigen::VectorXd v = u;
    Eigen::VectorXd a = u;
    Eigen::VectorXd old_force = u;
    for (int step = 0; step < 300; ++step) {
      ASSERT_LT((method->current().displacement_m - u).cwiseAbs().maxCoeff(), 1e-11) << rho_inf << " step " << step;
      const Eigen::VectorXd force = load(step) - stiffness * u - damping * v;
      if (step > 0) {
        a = inertia.partialPivLu().solve((1.0 - with.alpha_f) * force + with.alpha_f * old_force -
                                         mass * (alpha_3 * a));
      }
      old_force = force;
      const Eigen::VectorXd weighted = alpha_1 * a;
      u += kStep_s * v + (0.5 + with.gamma) * kStep_s * kStep_s * weighted;
      v += kStep_s * weighted;
      method->advance(stiffness * method->current().displacement_m, load(step));
    }
  }
}

TEST(InitialStiffnessMethods, FreeVibrationIsThatOfAverageAcceleration) {
  // With modes far above the explicit limit: omega dt up to 40.
  const LinearStructure building = test::shear_building(5, 1.0e4, 1.0e9);
  constexpr double kStep_s = 0.065;
  const InitialMotion initial{Eigen::VectorXd::LinSpaced(5, 0.0, 0.1), Eigen::VectorXd::LinSpaced(5, 1.0, -1.0)};
  const Eigen::VectorXd no_load = Eigen::VectorXd::Zero(5);
  const auto force_n = [&](const MotionState& command) -> Eigen::VectorXd {
    return building.initial_stiffness_n_per_m * command.displacement_m;
  };
  for (const IntegrationMethod& method : {test::cr(), test::operator_splitting(0.0)}) {
    const auto integrator = method.make(building, kStep_s, initial);
    const auto reference = test::implicit_newmark().make(building, kStep_s, initial);
    for (int step = 0; step < 500; ++step) {
      complete_step(*integrator, force_n, no_load);
      complete_step(*reference, force_n, no_load);
      ASSERT_LT((integrator->completed().displacement_m - reference->completed().displacement_m).cwiseAbs().maxCoeff(),
                1e-10)
          << method.name << " step " << step;
    }
  }
}

TEST(InitialStiffnessMethods, KeepTheEnergyOfAverageAcceleration) {
  const LinearStructure building = test::shear_building(5, 1.0e4, 1.0e9);
  constexpr double kStep_s = 0.065;
  for (const IntegrationMethod& method : {test::cr(), test::operator_splitting(0.0), test::implicit_newmark()}) {
    // h^T M h/2 + mean(u)^T K mean(u)/2 with h = (u_{i+1} - u_i)/dt is what average acceleration conserves.
    const auto integrator =
        method.make(building, kStep_s, {Eigen::VectorXd::LinSpaced(5, 0.0, 0.1), Eigen::VectorXd::Zero(5)});
    Eigen::VectorXd before;
    double first = 0.0;
    for (int step = 0; step < 5000; ++step) {
      complete_step(
          *integrator,
          [&](const MotionState& command) -> Eigen::VectorXd {
            return building.initial_stiffness_n_per_m * command.displacement_m;
          },
          Eigen::VectorXd::Zero(5));
      const Eigen::VectorXd now = integrator->completed().displacement_m;
      if (step > 0) {
        const Eigen::VectorXd velocity = (now - before) / kStep_s;
        const Eigen::VectorXd mean = 0.5 * (now + before);
        const double energy =
            0.5 * velocity.dot(building.mass_kg * velocity) + 0.5 * mean.dot(building.initial_stiffness_n_per_m * mean);
        if (step == 1) first = energy;
        ASSERT_NEAR(energy / first, 1.0, 1e-9) << method.name << " step " << step;
      }
      before = now;
    }
  }
}

}  // namespace
}  // namespace hybridtest
