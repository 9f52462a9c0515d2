#include "compensation/optimal_pick.hpp"

#include <cmath>
#include <limits>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {
namespace {

std::size_t checked_window(const OptimalPick::Parameters& parameters, double control_period_s) {
  return checked_periods("window_s", checked(parameters).window_s, checked_control_period(control_period_s), 1,
                         "the pick is among samples");
}

}  // namespace

OptimalPick::OptimalPick(const Parameters& parameters, double control_period_s)
    : displacements_m_{checked_window(parameters, control_period_s) + 1}, forces_n_{displacements_m_.capacity()} {}

double OptimalPick::corrected_force(const ForceSample& sample) noexcept {
  displacements_m_.push(sample.measured_displacement_m);
  forces_n_.push(sample.measured_force_n);
  const bool is_known = std::isfinite(sample.desired_displacement_m) && std::isfinite(sample.measured_displacement_m) &&
                        std::isfinite(sample.measured_force_n);
  if (!is_known) return std::numeric_limits<double>::quiet_NaN();
  if (sample.desired_displacement_m != desired_m_) is_rising_ = sample.desired_displacement_m > desired_m_;
  desired_m_ = sample.desired_displacement_m;
  return picked(desired_m_);
}

double OptimalPick::picked(double desired_m) const noexcept {
  double passages_n = 0.0;
  int passages = 0;
  double nearest_m = std::abs(displacements_m_[0] - desired_m);
  double nearest_n = forces_n_[0];
  for (std::size_t age = 1; age < displacements_m_.capacity(); ++age) {
    const double older_m = displacements_m_[age];
    const double newer_m = displacements_m_[age - 1];
    const bool is_passage =
        is_rising_ ? older_m <= desired_m && desired_m < newer_m : older_m >= desired_m && desired_m > newer_m;
    if (is_passage && std::isfinite(forces_n_[age]) && std::isfinite(forces_n_[age - 1])) {
      const double fraction = (desired_m - older_m) / (newer_m - older_m);
      passages_n += forces_n_[age] + fraction * (forces_n_[age - 1] - forces_n_[age]);
      ++passages;
    }
    const double distance_m = std::abs(older_m - desired_m);
    if (distance_m < nearest_m && std::isfinite(forces_n_[age])) {
      nearest_m = distance_m;
      nearest_n = forces_n_[age];
    }
  }
  return passages > 0 ? passages_n / passages : nearest_n;
}

void OptimalPick::reset() noexcept {
  displacements_m_.clear();
  forces_n_.clear();
  desired_m_ = 0.0;
  is_rising_ = true;
}

}  // namespace hybridtest
