#include "mechanics/laws/bouc_wen_baber_noori.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"
#include "mechanics/laws/power.hpp"

namespace hybridtest {
namespace {

/// Way in units of zu after which z has long reached its limit, whatever it was: of a longer one only the end matters.
constexpr double kLongWay = 128.0;
/// Of one way: where it hardly pinches, a long one takes kLongWay times substeps_per_length.
constexpr int kPinchSubstepsMax = 1 << 15;
/// Distance from the middle of the pinched range over zeta2 beyond which pinching is less than exp(-16) = 1e-7, and
/// less than rounding.
constexpr double kPinchedReach = 4.0;
constexpr double kPinchedAtAll = 6.0;

}  // namespace

BoucWenBaberNoori::BoucWenBaberNoori(const Parameters& parameters, double substeps_per_length)
    : parameters_{checked(parameters)}, substeps_per_length_{substeps_per_length} {
  expect_in_range("gamma_per_m", parameters.gamma_per_m, {.low = -parameters.beta_per_m, .low_open = true});
  virgin_.degraded = at_energy(0.0);
  reset();
}

double BoucWenBaberNoori::initial_stiffness_n_per_m() const noexcept {
  return (parameters_.alpha + (1.0 - parameters_.alpha) * parameters_.ao) * parameters_.stiffness_n_per_m;
}

double BoucWenBaberNoori::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  trial_ = committed_;
  const double increment_m = displacement_m - committed_.displacement_m;
  if (std::isnan(increment_m)) {  // has no number of substeps
    trial_.displacement_m = trial_.hysteretic_m = increment_m;
    return increment_m;
  }
  const double direction = increment_m < 0.0 ? -1.0 : 1.0;
  const Degraded& now = trial_.degraded;
  double left_m = std::min(std::abs(increment_m), kLongWay * now.softness * now.ultimate_m / parameters_.ao);
  for (int i = 0; i < kPinchSubstepsMax && left_m > 0.0; ++i) {
    const double most_m = substep_m(trial_, direction);
    const double step_m = left_m <= most_m ? left_m : left_m / std::ceil(left_m / most_m);
    advance(trial_, direction * step_m);
    left_m -= step_m;
  }
  trial_.displacement_m = displacement_m;
  return parameters_.stiffness_n_per_m *
         (parameters_.alpha * displacement_m + (1.0 - parameters_.alpha) * trial_.hysteretic_m);
}

BoucWenBaberNoori::Degraded BoucWenBaberNoori::at_energy(double energy_j) const noexcept {
  const Parameters& p = parameters_;
  Degraded degraded;
  degraded.strength = 1.0 + p.strength_degradation_per_j * energy_j;
  degraded.softness = 1.0 + p.stiffness_degradation_per_j * energy_j;
  degraded.ultimate_m = power_of(p.ao / (degraded.strength * (p.gamma_per_m + p.beta_per_m)), 1.0 / p.n);
  if (p.pinching == 0.0) return degraded;
  degraded.pinching = p.pinching * -std::expm1(-p.pinching_rate_per_j * energy_j);
  degraded.width_m = (p.pinching_width_m + p.width_rate_m_per_j * energy_j) * (p.width_share + degraded.pinching);
  return degraded;
}

double BoucWenBaberNoori::substep_m(const State& state, double direction) const noexcept {
  const Degraded& degraded = state.degraded;
  // Nowhere does z move faster.
  const double way_over_z = degraded.softness / parameters_.ao;
  const double usual_m = degraded.ultimate_m / substeps_per_length_;
  if (parameters_.pinching == 0.0) return way_over_z * usual_m;
  const double pinched_m = degraded.width_m / substeps_per_length_;
  if (pinched_m >= usual_m) return way_over_z * usual_m;
  const double level_m = parameters_.pinching_level * degraded.ultimate_m;
  const double outside_m = std::abs(state.hysteretic_m * direction - level_m) - kPinchedReach * degraded.width_m;
  return way_over_z * std::clamp(outside_m, pinched_m, usual_m);
}

double BoucWenBaberNoori::slope(double hysteretic_m, double direction, const Degraded& degraded) const noexcept {
  const Parameters& p = parameters_;
  const double loading = hysteretic_m * direction >= 0.0 ? p.gamma_per_m + p.beta_per_m : p.gamma_per_m - p.beta_per_m;
  const double slope = (p.ao - degraded.strength * loading * power_of(std::abs(hysteretic_m), p.n)) / degraded.softness;
  if (p.pinching == 0.0) return slope;
  const double from_slip = (hysteretic_m * direction - p.pinching_level * degraded.ultimate_m) / degraded.width_m;
  if (std::abs(from_slip) > kPinchedAtAll) return slope;
  return slope * (1.0 - degraded.pinching * std::exp(-from_slip * from_slip));
}

void BoucWenBaberNoori::advance(State& state, double increment_m) const noexcept {
  const double direction = increment_m < 0.0 ? -1.0 : 1.0;
  const double power = (1.0 - parameters_.alpha) * parameters_.stiffness_n_per_m;
  const double z = state.hysteretic_m;
  const double e = state.energy_j;
  const double half_m = 0.5 * increment_m;
  // Within a substep the energy that z gives back can be more than there is.
  state.degraded = at_energy(std::max(0.0, e + half_m * power * z));
  const double k1 = slope(z, direction, state.degraded);
  const double z2 = z + half_m * k1;
  const double k2 = slope(z2, direction, state.degraded);
  const double k3 = slope(z + increment_m * (2.0 * k2 - k1), direction, state.degraded);
  state.hysteretic_m = z + increment_m / 6.0 * (k1 + 4.0 * k2 + k3);
  state.energy_j = std::max(0.0, e + increment_m / 6.0 * power * (z + 4.0 * z2 + state.hysteretic_m));
}

}  // namespace hybridtest
