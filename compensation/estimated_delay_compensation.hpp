#pragma once

#include <memory>

#include "compensation/compensator.hpp"
#include "compensation/delay_adaptive.hpp"
#include "compensation/delay_estimator.hpp"

namespace hybridtest {

/// A compensator whose delay an estimator drives.
///
/// The estimator is given each command that was sent and the displacement measured at the instant of
/// that command, so that it sees the transfer system as it is, whatever is compensated already: the
/// estimate does not chase its own effect. A network in the loop is added by set_network_latency().
class EstimatedDelayCompensation final : public Compensator {
 public:
  /// @param compensator   also a DelayAdaptive.
  /// @param estimator     not null.
  /// @throws ConfigError where the compensator has no delay to set, or cannot make up for initial_delay_s.
  EstimatedDelayCompensation(std::unique_ptr<Compensator> compensator, std::unique_ptr<DelayEstimator> estimator);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override;

  /// @param latency_s   [s] there and back, as newest measured; see DelayEstimator.
  void set_network_latency(double latency_s) noexcept { estimator_->set_network_latency(latency_s); }
  /// The delay [s] that is made up for at present.
  [[nodiscard]] double delay_s() const noexcept { return adaptive_->delay_s(); }

 private:
  std::unique_ptr<Compensator> compensator_;
  DelayAdaptive* adaptive_;  // the compensator's other face
  std::unique_ptr<DelayEstimator> estimator_;
  double sent_m_ = 0.0;
  bool has_sent_ = false;
};

}  // namespace hybridtest
