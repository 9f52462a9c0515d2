#include "mechanics/laws/giuffre_menegotto_pinto.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"
#include "mechanics/laws/power.hpp"

namespace hybridtest {
namespace {

constexpr double kHardeningExponent = 0.8;  // Filippou, Popov and Bertero (1983)

}  // namespace

GiuffreMenegottoPinto::GiuffreMenegottoPinto(const Parameters& parameters) : parameters_{checked(parameters)} {
  yield_displacement_m_ = parameters.yield_force_n / parameters.stiffness_n_per_m;
  reset();
}

GiuffreMenegottoPinto::State GiuffreMenegottoPinto::virgin() const noexcept {
  State state;
  state.highest_reversal_m = yield_displacement_m_;
  state.lowest_reversal_m = -yield_displacement_m_;
  return state;
}

double GiuffreMenegottoPinto::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  const double increment_m = displacement_m - committed_.displacement_m;
  State next = committed_;
  const Branch heading = increment_m > 0.0 ? Branch::rising : Branch::falling;
  const bool turns = increment_m != 0.0 && committed_.branch != heading;
  if (turns && std::abs(increment_m) <= least_reversal_m_) {
    trial_ = committed_;
    return committed_.force_n + parameters_.stiffness_n_per_m * increment_m;
  }
  if (turns) begin_branch(next, heading);
  next.force_n = force_n(next, displacement_m);
  next.displacement_m = displacement_m;
  trial_ = next;
  return next.force_n;
}

/// How far out the asymptote is that a branch is heading for, over where first loading has it.
double GiuffreMenegottoPinto::hardening(const State& state, Branch branch) const noexcept {
  if (state.branch == Branch::virgin) return 1.0;
  const double amount = branch == Branch::rising ? parameters_.a3 : parameters_.a1;
  if (amount == 0.0) return 1.0;
  const double reference = branch == Branch::rising ? parameters_.a4 : parameters_.a2;
  const double range_m = state.highest_reversal_m - state.lowest_reversal_m;
  return 1.0 + amount * std::pow(range_m / (2.0 * reference * yield_displacement_m_), kHardeningExponent);
}

/// The reversal is where `state` stands; the virgin state counts as one.
void GiuffreMenegottoPinto::begin_branch(State& state, Branch branch) const noexcept {
  const double hardening_ratio = parameters_.hardening_ratio;
  const double side = branch == Branch::rising ? 1.0 : -1.0;
  state.highest_reversal_m = std::max(state.highest_reversal_m, state.displacement_m);
  state.lowest_reversal_m = std::min(state.lowest_reversal_m, state.displacement_m);
  const double yield_m = side * hardening(state, branch) * yield_displacement_m_;
  state.branch = branch;
  state.reversal_displacement_m = state.displacement_m;
  state.reversal_force_n = state.force_n;
  state.corner_displacement_m =
      yield_m + (state.displacement_m - state.force_n / parameters_.stiffness_n_per_m) / (1.0 - hardening_ratio);
  const double extreme_m = branch == Branch::rising ? state.highest_reversal_m : state.lowest_reversal_m;
  const double xi = std::abs(extreme_m - state.corner_displacement_m) / yield_displacement_m_;
  state.curvature = parameters_.r0 * (1.0 - parameters_.cr1 * xi / (parameters_.cr2 + xi));
}

double GiuffreMenegottoPinto::force_n(const State& state, double displacement_m) const noexcept {
  const double from_reversal_m = displacement_m - state.reversal_displacement_m;
  // Also keeps 0 / 0 out where a reversal falls on the asymptote itself.
  if (from_reversal_m == 0.0) return state.reversal_force_n;
  const double ratio = std::abs(from_reversal_m / (state.corner_displacement_m - state.reversal_displacement_m));
  // (1 + r^R)^(1/R), which must not overflow where r^R does.
  const double curvature = state.curvature;
  const double rounding = ratio <= 1.0 ? power_of(1.0 + power_of(ratio, curvature), 1.0 / curvature)
                                       : ratio * power_of(1.0 + power_of(ratio, -curvature), 1.0 / curvature);
  const double hardening_ratio = parameters_.hardening_ratio;
  return state.reversal_force_n +
         parameters_.stiffness_n_per_m * from_reversal_m * (hardening_ratio + (1.0 - hardening_ratio) / rounding);
}

}  // namespace hybridtest
