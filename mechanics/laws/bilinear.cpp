#include "mechanics/laws/bilinear.hpp"

#include <algorithm>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

Bilinear::Bilinear(const Parameters& parameters) : stiffness_n_per_m_{checked(parameters).stiffness_n_per_m} {
  const double ratio = parameters.hardening_ratio;
  hardening_stiffness_n_per_m_ = ratio * stiffness_n_per_m_;
  plastic_stiffness_n_per_m_ = (1.0 - ratio) * stiffness_n_per_m_;
  yield_displacement_m_ = parameters.yield_force_n / stiffness_n_per_m_;
}

double Bilinear::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  const double elastic_m =
      std::clamp(displacement_m - committed_plastic_m_, -yield_displacement_m_, yield_displacement_m_);
  trial_plastic_m_ = displacement_m - elastic_m;
  return hardening_stiffness_n_per_m_ * displacement_m + plastic_stiffness_n_per_m_ * elastic_m;
}

}  // namespace hybridtest
