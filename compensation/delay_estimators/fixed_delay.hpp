#pragma once

#include "compensation/delay_estimator.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// The delay that it is told, to which the network latency is added: for transfer systems whose delay is
/// known, on networks whose latency is not.
class FixedDelay final : public DelayEstimator {
 public:
  struct Parameters {
    DelayLimits limits;  // initial_delay_s is the delay

    void serialize(ParameterArchive& archive) { limits.serialize(archive); }
  };

  /// @throws ConfigError for values outside their ranges.
  FixedDelay(const Parameters& parameters, double control_period_s)
      : DelayEstimator{parameters.limits, control_period_s} {}

 private:
  void observe(const DelaySample&) noexcept override {}
  void forget() noexcept override {}
};

}  // namespace hybridtest
