#pragma once

#include "compensation/compensator.hpp"
#include "compensation/delay_adaptive.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Inverse compensation (Chen and Ricles, Earthquake Engng Struct. Dyn. 38, 2009).
///
/// The transfer system is taken to go, in one control period T, the part 1/alpha of the way to the
/// command, x_m(k+1) = x_m(k) + (u(k+1) - x_m(k)) / alpha, which makes it late by
/// (alpha - 1) T at low frequency. The inverse of that,
///
///     command(k) = alpha target(k) - (alpha - 1) target(k - 1),   alpha = 1 + delay/T,
///
/// extrapolates along the straight line through the last two targets.
///
/// Exact for constant velocity; the identity at zero delay. Its gain grows with frequency to
/// 2 alpha - 1 at half the control rate, so that it is for smooth targets.
class InverseCompensation final : public Compensator, public DelayAdaptive {
 public:
  static constexpr double kDelaySMax = 1.0;
  struct Parameters {
    double delay_s = 0.020;

    void serialize(ParameterArchive& archive) {
      archive.required("delay_s", delay_s,
                       {{.low = 0.0, .high = kDelaySMax}, "to make up for", "velocity is not constant for longer"});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  InverseCompensation(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override;

  void set_delay(double delay_s) noexcept override;
  [[nodiscard]] double delay_s() const noexcept override { return delay_s_; }
  [[nodiscard]] double delay_s_max() const noexcept override { return kDelaySMax; }
  /// 2 alpha - 1: the most by which a bounded error of the targets can grow.
  [[nodiscard]] double noise_gain() const noexcept { return 1.0 + 2.0 * delay_s_ / control_period_s_; }

 private:
  double initial_delay_s_;
  double control_period_s_;
  double delay_s_ = 0.0;
  SampleHistory targets_m_;
};

}  // namespace hybridtest
