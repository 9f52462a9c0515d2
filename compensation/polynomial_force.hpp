#pragma once

#include "compensation/delay_adaptive.hpp"
#include "compensation/force_compensator.hpp"
#include "compensation/polynomial_extrapolation.hpp"

namespace hybridtest {

/// Polynomial extrapolation of the measured force, which belongs to a displacement the delay ago
/// (Horiuchi, Inoue, Konno and Namita, Earthquake Engng Struct. Dyn. 28, 1999; compared with the
/// extrapolation of the displacement in the founding study of this project).
///
///     force(t) = sum over j of w_j measured_force(t - j T)
///     w_j = product over l != j of (s + l) / (l - j),   s = delay / T
///
/// Exact for forces that are polynomials of that order in time, the identity at zero delay. A load
/// cell is noisier than a target, and the specimen may yield within the delay, so that this serves
/// short delays (the sample or two of a loop) better than those of an actuator.
class PolynomialForce final : public ForceCompensator, public DelayAdaptive {
 public:
  using Parameters = PolynomialParameters;

  /// @param control_period_s   [s] corrected_force() is called once in each.
  /// @throws ConfigError for values outside the ranges of PolynomialParameters.
  PolynomialForce(const Parameters& parameters, double control_period_s)
      : extrapolation_{parameters, control_period_s} {}

  [[nodiscard]] double corrected_force(const ForceSample& sample) noexcept override {
    return extrapolation_.advance(sample.measured_force_n);
  }
  void reset() noexcept override { extrapolation_.reset(); }

  /// The point spacing stays.
  void set_delay(double delay_s) noexcept override { extrapolation_.set_delay(delay_s); }
  [[nodiscard]] double delay_s() const noexcept override { return extrapolation_.delay_s(); }
  [[nodiscard]] double delay_s_max() const noexcept override { return extrapolation_.delay_s_max(); }
  /// Sum of |w_j| at full order: the most by which a bounded error of the forces can grow.
  [[nodiscard]] double noise_gain() const noexcept { return extrapolation_.noise_gain(); }

 private:
  PolynomialExtrapolation extrapolation_;
};

}  // namespace hybridtest
