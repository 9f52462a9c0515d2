#pragma once

namespace hybridtest {

/// A compensator whose delay may change from sample to sample, so that a DelayEstimator can drive it.
class DelayAdaptive {
 public:
  virtual ~DelayAdaptive() = default;

  /// Takes effect with the next sample. Allocates nothing.
  /// @param delay_s   [s] outside 0 to delay_s_max() moved to the nearest; non-finite ignored.
  virtual void set_delay(double delay_s) noexcept = 0;
  /// The delay [s] that the next sample makes up for.
  [[nodiscard]] virtual double delay_s() const noexcept = 0;
  /// [s]
  [[nodiscard]] virtual double delay_s_max() const noexcept = 0;
};

}  // namespace hybridtest
