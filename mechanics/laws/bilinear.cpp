#include "mechanics/laws/bilinear.hpp"

#include <algorithm>

#include "core/parameters/checked_parameter.hpp"

namespace hybridtest {
namespace {

constexpr Range kHardeningRatio{.low = 0.0, .high = 1.0, .high_open = true};

}  // namespace

Bilinear::Bilinear(const Parameters& parameters)
    : stiffness_n_per_m_{checked("stiffness_n_per_m", parameters.stiffness_n_per_m, kPositive)} {
  const double yield_force = checked("yield_force_n", parameters.yield_force_n, kPositive);
  const double ratio = checked("hardening_ratio", parameters.hardening_ratio, kHardeningRatio);
  hardening_stiffness_n_per_m_ = ratio * stiffness_n_per_m_;
  plastic_stiffness_n_per_m_ = (1.0 - ratio) * stiffness_n_per_m_;
  yield_displacement_m_ = yield_force / stiffness_n_per_m_;
}

double Bilinear::trial(double displacement_m, double /*velocity_m_per_s*/) noexcept {
  const double elastic_m =
      std::clamp(displacement_m - committed_plastic_m_, -yield_displacement_m_, yield_displacement_m_);
  trial_plastic_m_ = displacement_m - elastic_m;
  return hardening_stiffness_n_per_m_ * displacement_m + plastic_stiffness_n_per_m_ * elastic_m;
}

}  // namespace hybridtest
