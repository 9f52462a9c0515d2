#include "mechanics/laws/ramberg_osgood.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"
#include "mechanics/laws/power.hpp"

namespace hybridtest {
namespace {

/// Newton's method from above on a convex curve: it falls until rounding stops it, in some ten steps.
constexpr int kNewtonStepsMax = 100;

}  // namespace

RambergOsgood::RambergOsgood(const Parameters& parameters) : parameters_{checked(parameters)} {
  yield_displacement_m_ = parameters.yield_force_n / parameters.stiffness_n_per_m;
}

double RambergOsgood::initial_stiffness_n_per_m() const noexcept {
  const double plastic = parameters_.exponent == 1.0 ? parameters_.offset_ratio : 0.0;
  return parameters_.stiffness_n_per_m / (1.0 + plastic);
}

double RambergOsgood::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  trial_ = committed_;
  const double increment_m = displacement_m - committed_.at.displacement_m;
  if (std::isnan(increment_m)) return increment_m;
  if (increment_m == 0.0) return committed_.at.force_n;
  trial_.direction = increment_m < 0.0 ? -1.0 : 1.0;
  Point turn = committed_.at;
  if (has_turned())
    trial_.turn_count = next_turn() + 1;
  else if (trial_.turn_count > 0)
    turn = turns_[trial_.turn_count - 1];
  // On the way to the reversal before, or to the mirror image of the only one.
  while (trial_.turn_count > 0) {
    const double closes_m = trial_.turn_count > 1 ? turns_[trial_.turn_count - 2].displacement_m : -turn.displacement_m;
    if (trial_.direction * (displacement_m - closes_m) <= 0.0) break;
    trial_.turn_count -= trial_.turn_count > 1 ? 2 : 1;
    if (trial_.turn_count > 0) turn = turns_[trial_.turn_count - 1];
  }
  trial_.at.displacement_m = displacement_m;
  trial_.at.force_n = trial_.turn_count == 0
                          ? first_loading_n(displacement_m)
                          : turn.force_n + 2.0 * first_loading_n(0.5 * (displacement_m - turn.displacement_m));
  return trial_.at.force_n;
}

void RambergOsgood::commit() noexcept {
  if (has_turned() && trial_.turn_count == next_turn() + 1) turns_[next_turn()] = committed_.at;
  committed_ = trial_;
}

double RambergOsgood::first_loading_n(double displacement_m) const noexcept {
  const double a = parameters_.offset_ratio;
  const double n = parameters_.exponent;
  const double way = std::abs(displacement_m) / yield_displacement_m_;
  double force = way;
  if (a > 0.0) force = std::min(way, power_of(way / a, 1.0 / n));
  for (int i = 0; i < kNewtonStepsMax && force > 0.0; ++i) {
    const double power = power_of(force, n - 1.0);
    const double next = force - (force * (1.0 + a * power) - way) / (1.0 + n * a * power);
    if (!(next < force)) break;
    force = next;
  }
  return std::copysign(force * parameters_.yield_force_n, displacement_m);
}

}  // namespace hybridtest
