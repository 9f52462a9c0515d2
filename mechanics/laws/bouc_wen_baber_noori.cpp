#include "mechanics/laws/bouc_wen_baber_noori.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

/// A step that crosses the whole loop 60 times; beyond, z has long reached its limit.
constexpr int kPinchSubstepsMax = 8192;

}  // namespace

BoucWenBaberNoori::BoucWenBaberNoori(const Parameters& parameters, double substeps_per_length)
    : parameters_{checked(parameters)}, substeps_per_length_{substeps_per_length} {
  expect_in_range("gamma_per_m", parameters.gamma_per_m, {.low = -parameters.beta_per_m, .low_open = true});
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
  const double pinching = pinching_at(committed_.energy_j);
  double length_m = ultimate_m(committed_.energy_j) / parameters_.ao;
  if (parameters_.pinching > 0.0) length_m = std::min(length_m, pinching_width_m(committed_.energy_j, pinching));
  const double substeps = std::ceil(std::abs(increment_m) / length_m * substeps_per_length_);
  const int count = static_cast<int>(std::clamp(substeps, 1.0, static_cast<double>(kPinchSubstepsMax)));
  // Of a longer way only the end matters.
  const double way_m = substeps > kPinchSubstepsMax
                           ? std::copysign(length_m / substeps_per_length_ * kPinchSubstepsMax, increment_m)
                           : increment_m;
  for (int i = 0; i < count && way_m != 0.0; ++i) advance(trial_, way_m / count);
  trial_.displacement_m = displacement_m;
  return parameters_.stiffness_n_per_m *
         (parameters_.alpha * displacement_m + (1.0 - parameters_.alpha) * trial_.hysteretic_m);
}

double BoucWenBaberNoori::ultimate_m(double energy_j) const noexcept {
  const double strength = 1.0 + parameters_.strength_degradation_per_j * energy_j;
  return std::pow(parameters_.ao / (strength * (parameters_.gamma_per_m + parameters_.beta_per_m)),
                  1.0 / parameters_.n);
}

double BoucWenBaberNoori::pinching_at(double energy_j) const noexcept {
  // Within a substep the energy that z gives back can be more than there is.
  return parameters_.pinching * -std::expm1(-parameters_.pinching_rate_per_j * std::max(0.0, energy_j));
}

double BoucWenBaberNoori::pinching_width_m(double energy_j, double pinching) const noexcept {
  return (parameters_.pinching_width_m + parameters_.width_rate_m_per_j * energy_j) *
         (parameters_.width_share + pinching);
}

double BoucWenBaberNoori::slope(double hysteretic_m, double energy_j, double direction) const noexcept {
  const Parameters& p = parameters_;
  const double loading = hysteretic_m * direction >= 0.0 ? p.gamma_per_m + p.beta_per_m : p.gamma_per_m - p.beta_per_m;
  const double strength = 1.0 + p.strength_degradation_per_j * energy_j;
  double slope = p.ao - strength * loading * std::pow(std::abs(hysteretic_m), p.n);
  slope /= 1.0 + p.stiffness_degradation_per_j * energy_j;
  if (p.pinching == 0.0) return slope;
  const double pinching = pinching_at(energy_j);
  const double level_m = p.pinching_level > 0.0 ? p.pinching_level * ultimate_m(energy_j) : 0.0;
  const double from_slip = (hysteretic_m * direction - level_m) / pinching_width_m(energy_j, pinching);
  return slope * (1.0 - pinching * std::exp(-from_slip * from_slip));
}

void BoucWenBaberNoori::advance(State& state, double increment_m) const noexcept {
  const double direction = increment_m < 0.0 ? -1.0 : 1.0;
  const double power = (1.0 - parameters_.alpha) * parameters_.stiffness_n_per_m;
  const double z = state.hysteretic_m;
  const double e = state.energy_j;
  const double half_m = 0.5 * increment_m;
  const double k1 = slope(z, e, direction);
  const double z2 = z + half_m * k1;
  const double k2 = slope(z2, e + half_m * power * z, direction);
  const double z3 = z + half_m * k2;
  const double k3 = slope(z3, e + half_m * power * z2, direction);
  const double z4 = z + increment_m * k3;
  const double k4 = slope(z4, e + increment_m * power * z3, direction);
  state.hysteretic_m = z + increment_m / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  state.energy_j = std::max(0.0, e + increment_m / 6.0 * power * (z + 2.0 * z2 + 2.0 * z3 + z4));
}

}  // namespace hybridtest
