#include "coordinator/force_bridge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace hybridtest {
namespace {

using Signal = std::function<double(double step)>;

InterfaceVector one(double value) { return InterfaceVector::Constant(1, value); }

ForceBridge make(BridgeType type, int order = 1, double stiffness = 0.0) {
  return ForceBridge{{.type = type, .order = order, .most_in_a_row = 4}, Eigen::MatrixXd::Constant(1, 1, stiffness), 1};
}

/// Measures steps 0 to `last` of a force.
void measure(ForceBridge& bridge, const Signal& force, Step last) {
  for (Step step = 0; step <= last; ++step) bridge.take(step, one(0.0), one(force(static_cast<double>(step))));
}

TEST(ForceBridge, HoldsTheLastMeasuredForce) {
  ForceBridge bridge = make(BridgeType::hold);
  measure(
      bridge, [](double step) { return 3.0 * step; }, 5);
  EXPECT_EQ(bridge.bridge(6, one(0.0))[0], 15.0);
  EXPECT_EQ(bridge.bridge(7, one(0.0))[0], 15.0) << "and not what was bridged";
}

TEST(ForceBridge, PolynomialIsExactUpToItsOrder) {
  const std::vector<Signal> powers{[](double) { return 7.0; }, [](double step) { return 2.0 - 3.0 * step; },
                                   [](double step) { return 0.5 * step * step - step; },
                                   [](double step) { return 0.25 * step * step * step; }};
  for (int order = 1; order <= 3; ++order) {
    for (std::size_t power = 0; power < powers.size(); ++power) {
      ForceBridge bridge = make(BridgeType::polynomial, order);
      measure(bridge, powers[power], 8);
      for (Step step = 9; step <= 11; ++step) {
        const double exact = powers[power](static_cast<double>(step));
        const double bridged = bridge.bridge(step, one(0.0))[0];
        if (power <= static_cast<std::size_t>(order)) {
          EXPECT_NEAR(bridged, exact, 1e-11 * std::abs(exact)) << "order " << order << ", power " << power;
        } else {
          EXPECT_GT(std::abs(bridged - exact), 0.1) << "order " << order << ", power " << power;
        }
      }
    }
  }
}

TEST(ForceBridge, PolynomialGoesThroughUnevenSteps) {
  ForceBridge bridge = make(BridgeType::polynomial, 2);
  const Signal parabola = [](double step) { return step * step; };
  measure(bridge, parabola, 3);
  static_cast<void>(bridge.bridge(4, one(0.0)));
  bridge.take(5, one(0.0), one(25.0));
  static_cast<void>(bridge.bridge(6, one(0.0)));
  EXPECT_NEAR(bridge.bridge(7, one(0.0))[0], 49.0, 1e-12 * 49.0) << "through steps 2, 3 and 5";
}

TEST(ForceBridge, OrderIsLowerUntilThereAreForces) {
  ForceBridge bridge = make(BridgeType::polynomial, 3);
  bridge.take(0, one(0.0), one(4.0));
  EXPECT_EQ(bridge.bridge(1, one(0.0))[0], 4.0);
}

TEST(ForceBridge, InitialStiffnessFollowsTheDisplacement) {
  ForceBridge bridge = make(BridgeType::initial_stiffness, 1, 1000.0);
  bridge.take(0, one(0.01), one(12.0));
  EXPECT_NEAR(bridge.bridge(1, one(0.03))[0], 32.0, 1e-12);
  EXPECT_NEAR(bridge.bridge(2, one(0.02))[0], 22.0, 1e-12) << "from the last measured force";
}

TEST(ForceBridge, LateForceIsUsedFromThenOn) {
  ForceBridge bridge = make(BridgeType::hold);
  bridge.take(0, one(0.0), one(1.0));
  static_cast<void>(bridge.bridge(1, one(0.0)));
  bridge.take_late(1, one(5.0));
  EXPECT_EQ(bridge.bridge(2, one(0.0))[0], 5.0);
}

TEST(ForceBridge, EnergyIsTheWorkOfTheMissingForce) {
  // A spring of 100 N/m moves by 1 mm a step; held at 2 mm, the force lacks 0.1 N and 0.2 N in the steps at 3 and 4 mm.
  ForceBridge bridge = make(BridgeType::hold);
  for (Step step = 0; step <= 2; ++step)
    bridge.take(step, one(0.001 * static_cast<double>(step)), one(0.1 * static_cast<double>(step)));
  static_cast<void>(bridge.bridge(3, one(0.003)));
  static_cast<void>(bridge.bridge(4, one(0.004)));
  EXPECT_TRUE(bridge.closed().empty()) << "the gap is still open";
  bridge.take(5, one(0.005), one(0.5));
  const auto closed = bridge.closed();
  ASSERT_EQ(closed.size(), 2U);
  EXPECT_EQ(closed[0].step, 3);
  EXPECT_EQ(closed[0].in_a_row, 1);
  EXPECT_EQ(closed[1].in_a_row, 2);
  // Interpolated between the forces at 2 mm and 5 mm, which is exact for a spring.
  EXPECT_NEAR(closed[0].energy_added_j, 0.1 * 0.001, 1e-15);
  EXPECT_NEAR(closed[1].energy_added_j, 0.2 * 0.001, 1e-15);
  EXPECT_FALSE(closed[0].came_late);
  EXPECT_TRUE(bridge.closed().empty()) << "each is told once";
}

TEST(ForceBridge, EnergyTakesTheForceThatCameLate) {
  ForceBridge bridge = make(BridgeType::hold);
  bridge.take(0, one(0.0), one(0.0));
  bridge.take(1, one(0.001), one(1.0));
  static_cast<void>(bridge.bridge(2, one(0.002)));
  bridge.take_late(2, one(9.0));  // not on the line between the others
  bridge.take(3, one(0.003), one(3.0));
  const auto closed = bridge.closed();
  ASSERT_EQ(closed.size(), 1U);
  EXPECT_TRUE(closed[0].came_late);
  EXPECT_NEAR(closed[0].energy_added_j, (9.0 - 1.0) * 0.001, 1e-15);
}

TEST(ForceBridge, GapAtTheEndHasNoKnownEnergy) {
  ForceBridge bridge = make(BridgeType::hold);
  bridge.take(0, one(0.0), one(0.0));
  static_cast<void>(bridge.bridge(1, one(0.001)));
  EXPECT_TRUE(bridge.closed().empty());
  const auto closed = bridge.closed(true);
  ASSERT_EQ(closed.size(), 1U);
  EXPECT_TRUE(std::isnan(closed[0].energy_added_j));
}

}  // namespace
}  // namespace hybridtest
