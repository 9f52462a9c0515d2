#pragma once

#include <memory>

#include "compensation/delay_adaptive.hpp"
#include "compensation/delay_estimator.hpp"
#include "compensation/force_compensator.hpp"

namespace hybridtest {

/// A compensator on forces whose delay an estimator drives: how late the measured displacement is behind
/// the desired one, so is the force. A network in the loop is added by set_network_latency().
class EstimatedDelayForceCompensation final : public ForceCompensator {
 public:
  /// @param compensator   also a DelayAdaptive.
  /// @param estimator     not null.
  /// @throws ConfigError where the compensator has no delay to set, or cannot make up for initial_delay_s.
  EstimatedDelayForceCompensation(std::unique_ptr<ForceCompensator> compensator,
                                  std::unique_ptr<DelayEstimator> estimator);

  [[nodiscard]] double corrected_force(const ForceSample& sample) noexcept override;
  void reset() noexcept override;

  /// @param latency_s   [s] there and back, as newest measured; see DelayEstimator.
  void set_network_latency(double latency_s) noexcept { estimator_->set_network_latency(latency_s); }
  /// The delay [s] that is made up for at present.
  [[nodiscard]] double delay_s() const noexcept { return adaptive_->delay_s(); }

 private:
  std::unique_ptr<ForceCompensator> compensator_;
  DelayAdaptive* adaptive_;  // the compensator's other face
  std::unique_ptr<DelayEstimator> estimator_;
};

}  // namespace hybridtest
