#include "compensation/estimated_delay_compensation.hpp"

#include <utility>

#include "compensation/estimated_delay.hpp"

namespace hybridtest {

EstimatedDelayCompensation::EstimatedDelayCompensation(std::unique_ptr<Compensator> compensator,
                                                       std::unique_ptr<DelayEstimator> estimator)
    : compensator_{std::move(compensator)},
      adaptive_{dynamic_cast<DelayAdaptive*>(compensator_.get())},
      estimator_{std::move(estimator)} {
  check_estimated_delay(adaptive_, estimator_.get());
  adaptive_->set_delay(estimator_->delay_s());
}

double EstimatedDelayCompensation::command(const CompensatorInput& input) noexcept {
  // The measurement is one sample old, and so is the newest command.
  if (has_sent_) adaptive_->set_delay(estimator_->estimate({sent_m_, input.measured_displacement_m}));
  sent_m_ = compensator_->command(input);
  has_sent_ = true;
  return sent_m_;
}

void EstimatedDelayCompensation::reset() noexcept {
  estimator_->reset();
  compensator_->reset();
  adaptive_->set_delay(estimator_->delay_s());
  sent_m_ = 0.0;
  has_sent_ = false;
}

}  // namespace hybridtest
