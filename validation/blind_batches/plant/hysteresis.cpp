#include "validation/blind_batches/plant/hysteresis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hybridtest::blind {
namespace {

constexpr std::size_t kElements = 40;

}  // namespace

History bristle_friction(const FrictionParameters& friction, const MotionHistory& motion) {
  const double bristle_stiffness = friction.force_n / friction.presliding_m;
  History force(motion.size());
  double deflection = 0.0;
  for (std::size_t i = 1; i < motion.size(); ++i) {
    // The step's own path: also right where the displacement jumps.
    const double path = motion.displacement_m[i] - motion.displacement_m[i - 1];
    const double velocity = path / motion.period_s;
    const double sliding = path < 0.0 ? friction.force_backward_n : friction.force_n;
    const double fading = velocity / friction.stribeck_m_per_s;
    const double slip =
        (sliding + (friction.breakaway_n - friction.force_n) * std::exp(-fading * fading)) / bristle_stiffness;
    const double limit = path < 0.0 ? -slip : slip;
    deflection = limit + (deflection - limit) * std::exp(-std::abs(path) / slip);
    force[i] = bristle_stiffness * deflection;
  }
  return force;
}

History iwan_stack(const StackParameters& stack, const History& displacement_m) {
  const double yield_m = stack.yield_force_n / stack.stiffness_n_per_m;
  const double element_stiffness =
      (1.0 - stack.hardening_ratio) * stack.stiffness_n_per_m / static_cast<double>(kElements);
  std::array<double, kElements> reach{};
  for (std::size_t e = 0; e < kElements; ++e) {
    const double place = (2.0 * static_cast<double>(e) + 1.0) / static_cast<double>(kElements) - 1.0;
    reach[e] = yield_m * (1.0 + stack.spread * place);
  }
  std::array<double, kElements> slip{};
  History force(displacement_m.size());
  for (std::size_t i = 0; i < displacement_m.size(); ++i) {
    const double x = displacement_m[i];
    double sum = 0.0;
    for (std::size_t e = 0; e < kElements; ++e) {
      slip[e] = std::clamp(slip[e], x - reach[e], x + reach[e]);
      sum += x - slip[e];
    }
    force[i] = element_stiffness * sum + stack.hardening_ratio * stack.stiffness_n_per_m * x;
  }
  return force;
}

}  // namespace hybridtest::blind
