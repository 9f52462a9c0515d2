#include "compensation/estimated_delay_force_compensation.hpp"

#include <utility>

#include "compensation/estimated_delay.hpp"

namespace hybridtest {

EstimatedDelayForceCompensation::EstimatedDelayForceCompensation(std::unique_ptr<ForceCompensator> compensator,
                                                                 std::unique_ptr<DelayEstimator> estimator)
    : compensator_{std::move(compensator)},
      adaptive_{dynamic_cast<DelayAdaptive*>(compensator_.get())},
      estimator_{std::move(estimator)} {
  check_estimated_delay(adaptive_, estimator_.get());
  adaptive_->set_delay(estimator_->delay_s());
}

double EstimatedDelayForceCompensation::corrected_force(const ForceSample& sample) noexcept {
  adaptive_->set_delay(estimator_->estimate({sample.desired_displacement_m, sample.measured_displacement_m}));
  return compensator_->corrected_force(sample);
}

void EstimatedDelayForceCompensation::reset() noexcept {
  estimator_->reset();
  compensator_->reset();
  adaptive_->set_delay(estimator_->delay_s());
}

}  // namespace hybridtest
