#pragma once

#include <cstddef>

#include "compensation/compensator.hpp"
#include "compensation/delay_adaptive.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Prediction with linearly varying acceleration (Horiuchi and Konno, Phil. Trans. R. Soc. A 359,
/// 2001): the acceleration at the end of the delay is extrapolated through the newest one and the
/// one a point spacing T ago; between now and then it is taken to vary linearly,
///
///     a_p = a + (delay/T) (a - a(t - T))
///     command = x + delay v + delay^2/6 (2 a + a_p)
///
/// with the integrator's own displacement x, velocity v and acceleration a. As published T is the
/// delay, which makes a_p = 2 a - a(t - delay).
///
/// Exact for motions that are polynomials of order 3; the identity at zero delay. Until one spacing
/// has passed since the first sample, the acceleration is taken to have been constant before it.
class LinearAcceleration final : public Compensator, public DelayAdaptive {
 public:
  struct Parameters {
    double delay_s = 0.020;
    double point_spacing_s = 0.0;

    void serialize(ParameterArchive& archive) {
      constexpr const char* kSpan = "acceleration is not linear in time for longer";
      archive.required("delay_s", delay_s, {kZeroToOne, "to make up for", kSpan, "0 to 1, at most 8 point spacings"});
      archive.optional("point_spacing_s", point_spacing_s,
                       {kZeroToOne, "between the two accelerations; 0: the delay itself", kSpan});
    }
  };
  static constexpr double kSpacingsAheadMax = 8.0;

  /// @throws ConfigError for values outside their ranges.
  LinearAcceleration(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override;
  void reset() noexcept override;

  /// The point spacing stays.
  void set_delay(double delay_s) noexcept override;
  [[nodiscard]] double delay_s() const noexcept override { return delay_s_; }
  [[nodiscard]] double delay_s_max() const noexcept override { return kSpacingsAheadMax * point_spacing_s_; }
  [[nodiscard]] double point_spacing_s() const noexcept { return point_spacing_s_; }

 private:
  double initial_delay_s_;
  std::size_t spacing_;  // control periods
  double point_spacing_s_;
  double delay_s_ = 0.0;
  SampleHistory accelerations_m_per_s2_;
};

}  // namespace hybridtest
