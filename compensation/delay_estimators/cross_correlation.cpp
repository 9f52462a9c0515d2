#include "compensation/delay_estimators/cross_correlation.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

// A window without any motion would fade into denormal numbers, which are slow.
constexpr double kNothing = 1e-60;

}  // namespace

CrossCorrelation::CrossCorrelation(const Parameters& parameters, double control_period_s)
    : DelayEstimator{parameters.limits, control_period_s},
      parameters_{checked(parameters)},
      keep_{std::exp(-control_period_s / parameters.memory_s)},
      half_{checked_periods("parabola_half_s", parameters.parabola_half_s, control_period_s, 1,
                            "the parabola goes through three samples")},
      comparison_{checked_periods("comparison_period_s", parameters.comparison_period_s, control_period_s, 1,
                                  "lags are compared at samples")},
      lags_{2 * half_ + 1 +
            checked_periods("delay_s_max", parameters.limits.delay_s_max, control_period_s, 1, "lags are samples")},
      measured_m_{half_ + 1},
      references_m_(2 * lags_, 0.0),
      correlations_m2_(lags_, 0.0),
      energies_m2_(lags_, 0.0) {}

void CrossCorrelation::observe(const DelaySample& sample) noexcept {
  measured_m_.push(sample.measured_displacement_m);
  accumulate(sample.reference_m, measured_m_[half_]);
  if (++since_comparison_ < comparison_) return;
  since_comparison_ = 0;
  const double mean_square_m2 = energies_m2_[0] * (1.0 - keep_);
  if (mean_square_m2 >= parameters_.motion_m_min * parameters_.motion_m_min) compare();
}

void CrossCorrelation::accumulate(double reference_m, double measured_m) noexcept {
  newest_ = newest_ == 0 ? lags_ - 1 : newest_ - 1;
  references_m_[newest_] = references_m_[newest_ + lags_] = reference_m;
  const double* const references_m = references_m_.data() + newest_;
  const double keep = energies_m2_[0] > kNothing ? keep_ : 0.0;
  for (std::size_t i = 0; i < lags_; ++i) {
    correlations_m2_[i] = keep * correlations_m2_[i] + references_m[i] * measured_m;
    energies_m2_[i] = keep * energies_m2_[i] + references_m[i] * references_m[i];
  }
}

double CrossCorrelation::likeness(std::size_t index) const noexcept {
  const double energy = energies_m2_[index];
  // The delay is no half cycle: opposite signals are not alike.
  if (!(energy > kNothing) || correlations_m2_[index] < 0.0) return 0.0;
  return correlations_m2_[index] * correlations_m2_[index] / energy;
}

void CrossCorrelation::compare() noexcept {
  const auto delay_min = static_cast<std::size_t>(std::ceil(limits().delay_s_min / control_period_s() - 1e-9));
  const std::size_t first = half_ + delay_min;
  const std::size_t last = lags_ - 1 - half_;
  std::size_t best = first;
  double largest = -1.0;
  for (std::size_t i = first; i <= last; ++i) {
    const double value = likeness(i);
    if (value > largest) {
      largest = value;
      best = i;
    }
  }
  const double before = likeness(best - half_);
  const double after = likeness(best + half_);
  const double curvature = before - 2.0 * largest + after;
  if (!(curvature < 0.0)) return;
  const auto half = static_cast<double>(half_);
  const double offset = std::clamp(0.5 * half * (before - after) / curvature, -half, half);
  believe((static_cast<double>(best) - half + offset) * control_period_s());
}

void CrossCorrelation::forget() noexcept {
  measured_m_.clear();
  for (auto* values : {&references_m_, &correlations_m2_, &energies_m2_}) {
    std::fill(values->begin(), values->end(), 0.0);
  }
  newest_ = since_comparison_ = 0;
}

}  // namespace hybridtest
