#include "mechanics/laws/elastomer.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

Elastomer::Elastomer(const Parameters& parameters)
    : parameters_{checked(parameters)},
      committed_filler_{parameters.payne_displacement_m},
      trial_filler_{committed_filler_} {}

double Elastomer::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  const Parameters& p = parameters_;
  trial_filler_ = committed_filler_;
  const double square = displacement_m * displacement_m;
  const double energy_j = 0.5 * square * (p.stiffness_n_per_m + 0.5 * p.stiffening_n_per_m3 * square);
  trial_largest_j_ = std::max(committed_largest_j_, energy_j);
  const double scale_j = 0.5 * p.stiffness_n_per_m * p.mullins_displacement_m * p.mullins_displacement_m;
  const double softening = p.mullins_softening * std::erf((trial_largest_j_ - energy_j) / scale_j);
  const double elastic_n = displacement_m * (p.stiffness_n_per_m + p.stiffening_n_per_m3 * square);
  return (1.0 - softening) * elastic_n + p.payne_force_n * trial_filler_.share(displacement_m);
}

void Elastomer::commit() noexcept {
  committed_largest_j_ = trial_largest_j_;
  committed_filler_ = trial_filler_;
}

void Elastomer::revert() noexcept {
  trial_largest_j_ = committed_largest_j_;
  trial_filler_ = committed_filler_;
}

void Elastomer::reset() noexcept {
  committed_largest_j_ = trial_largest_j_ = 0.0;
  committed_filler_.reset();
  trial_filler_.reset();
}

double Elastomer::initial_stiffness_n_per_m() const noexcept {
  return parameters_.stiffness_n_per_m + parameters_.payne_force_n / parameters_.payne_displacement_m;
}

}  // namespace hybridtest
