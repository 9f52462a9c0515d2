#pragma once

#include "compensation/compensator.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Adaptive inverse compensation (Chen and Ricles, Smart Mater. Struct. 19, 2010): inverse
/// compensation (inverse_compensation.hpp) with
///
///     alpha = 1 + delay/T + d_alpha,   d_alpha = kp TI + ki (integral of TI over time)
///
/// TI is the tracking indicator of Mercan and Ricles (2007), half the difference between the areas
/// on either side of the path that target x and measurement x_m draw against each other,
///
///     TI += 1/4 [(x(k) + x(k-1)) (x_m(k) - x_m(k-1)) - (x_m(k) + x_m(k-1)) (x(k) - x(k-1))]
///
/// (sign such that it grows while x_m is late). The measurement is one sample old and is set against
/// the target of its own instant.
///
/// Interpretation, the papers' text not having been at hand: the limit of d_alpha, here one of the
/// delay it stands for, and the gains. Those have the unit of an inverse area, so that they belong to
/// a motion; the defaults suit motions of some millimetres.
class AdaptiveInverse final : public Compensator {
 public:
  struct Parameters {
    double delay_s = 0.020;
    double proportional_gain_per_m2 = 1e6;
    double integral_gain_per_m2_s = 1e5;
    double delay_correction_s_max = 0.010;

    void serialize(ParameterArchive& archive) {
      constexpr Range kGain{.low = 0.0, .high = 1e12};
      constexpr const char* kSpan = "velocity is not constant for longer";
      constexpr const char* kSign = "a negative gain makes the delay run away";
      archive.required("delay_s", delay_s, {kZeroToOne, "at first", kSpan});
      archive.optional("proportional_gain_per_m2", proportional_gain_per_m2,
                       {kGain, "kp, on the tracking indicator; suits motions of some millimetres", kSign});
      archive.optional("integral_gain_per_m2_s", integral_gain_per_m2_s, {kGain, "ki, on its integral", kSign});
      archive.optional("delay_correction_s_max", delay_correction_s_max,
                       {kZeroToOne, "by which the delay moves from the first one", kSpan});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  AdaptiveInverse(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override;

  /// The delay [s] that is made up for at present, (alpha - 1) T. At low frequency.
  [[nodiscard]] double delay_s() const noexcept { return parameters_.delay_s + correction_s_; }

 private:
  void observe(double target_m, double measured_m) noexcept;

  Parameters parameters_;
  double control_period_s_;
  SampleHistory targets_m_{2};
  double observed_target_m_ = 0.0;  // of the newest measurement taken in
  double observed_displacement_m_ = 0.0;
  bool has_observed_ = false;
  double indicator_m2_ = 0.0;
  double integral_m2_s_ = 0.0;
  double correction_s_ = 0.0;
  bool has_target_ = false;
};

}  // namespace hybridtest
