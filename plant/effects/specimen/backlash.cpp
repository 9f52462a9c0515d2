#include "plant/effects/specimen/backlash.hpp"

namespace hybridtest {

void SpecimenBacklash::before(const StageSample& /*sample*/, Motion& motion) noexcept {
  const double actuator_m = motion.displacement_m;
  const double forward_m = side_ * (actuator_m - actuator_m_);
  actuator_m_ = actuator_m;
  if (forward_m < 0.0 && !goes_back_) reversal_force_n_ = force_n_;
  if (forward_m != 0.0) goes_back_ = forward_m < 0.0;
  if (goes_back_ && side_ * force_n_ <= holding_ratio_ * side_ * reversal_force_n_) side_ = 0.0;
  if (actuator_m - position_m_ >= half_clearance_m_) side_ = 1.0;
  if (position_m_ - actuator_m >= half_clearance_m_) side_ = -1.0;
  if (side_ == 0.0) {
    goes_back_ = false;
    motion.velocity_m_per_s = motion.acceleration_m_per_s2 = 0.0;
  } else {
    position_m_ = actuator_m - side_ * half_clearance_m_;
  }
  motion.displacement_m = position_m_;
}

void SpecimenBacklash::reset() noexcept { side_ = position_m_ = actuator_m_ = force_n_ = reversal_force_n_ = 0.0; }

}  // namespace hybridtest
