#include "mechanics/laws/self_centring.hpp"

#include <algorithm>
#include <cmath>

#include "core/parameters/parameter_checker.hpp"

namespace hybridtest {

SelfCentring::SelfCentring(const Parameters& parameters) : parameters_{checked(parameters)} {
  upper_m_ = parameters.activation_force_n / parameters.stiffness_n_per_m;
  lower_m_ = (1.0 - parameters.flag_ratio) * upper_m_;
}

double SelfCentring::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  const double size_m = std::abs(displacement_m);
  // Only the side of the displacement can have slipped.
  const double before_m = committed_slip_m_ * displacement_m > 0.0 ? std::abs(committed_slip_m_) : 0.0;
  const double slip_m = std::max(0.0, std::clamp(before_m, size_m - upper_m_, size_m - lower_m_));
  trial_slip_m_ = std::copysign(slip_m, displacement_m);
  return parameters_.stiffness_n_per_m * (displacement_m - (1.0 - parameters_.hardening_ratio) * trial_slip_m_);
}

}  // namespace hybridtest
