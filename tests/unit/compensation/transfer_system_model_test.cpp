#include "compensation/transfer_system_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "core/config_error.hpp"
#include "core/parameters/parameter_checker.hpp"
#include "tests/unit/compensation/transfer_system_plant.hpp"

namespace hybridtest {
namespace {

TEST(TransferSystemModel, HasTheInverseOfItsEquations) {
  const TransferSystemModel model;
  const auto coefficients = model.inverse_coefficients();
  for (const double omega : {0.1, 3.0, 30.0, 200.0, 1000.0}) {
    const std::complex<double> s{0.0, omega};
    std::complex<double> polynomial = 0.0;
    for (int i = 5; i >= 0; --i) polynomial = polynomial * s + coefficients[static_cast<std::size_t>(i)];
    const std::complex<double> expected = inverse_transfer_function(model, s);
    EXPECT_LT(std::abs(polynomial - expected), 1e-13 * std::abs(expected));  // rounding
  }
}

TEST(TransferSystemModel, IsDiscretisedExactly) {
  const TransferSystemModel model;
  for (const double period_s : {1.0 / 4096.0, 1.0 / 1024.0, 0.01}) {
    const DiscreteTransferSystem discrete = discretised(model, period_s);
    TransferSystemPlant plant{model};
    TransferSystemModel::State state = TransferSystemModel::State::Zero();
    for (int i = 0; i < 50; ++i) {
      const double command_m = i % 7 < 3 ? 1e-3 : -2e-3;
      state = (discrete.transition * state + discrete.input * command_m).eval();
      plant.advance(command_m, period_s, 400);
    }
    // Runge-Kutta's error: (450/s 0.01 s / 400)^4 = 2e-8 a step at the longest period, 5e-11 in the sum of its
    // oscillating terms.
    EXPECT_NEAR(state(TransferSystemModel::kDisplacement), plant.displacement_m(), 1e-9 * 2e-3);
    EXPECT_NEAR(state(TransferSystemModel::kForce) * discrete.scale(TransferSystemModel::kForce), plant.force_n(),
                1e-9 * 2e-3 * 1.19e6);
  }
}

TEST(TransferSystemModel, RejectsModelWithoutInverse) {
  TransferSystemModel model;
  EXPECT_NO_THROW(static_cast<void>(checked(model)));
  model.gain = 0.0;
  EXPECT_THROW(static_cast<void>(checked(model)), ConfigError);
  model = {};
  model.stiffness_n_per_m = -1.0;
  EXPECT_THROW(static_cast<void>(checked(model)), ConfigError);
  model = {};
  model.a3_per_s = 0.0;
  EXPECT_NO_THROW(static_cast<void>(checked(model)));
  model.a3_per_s = std::nan("");
  EXPECT_THROW(static_cast<void>(checked(model)), ConfigError);
}

}  // namespace
}  // namespace hybridtest
