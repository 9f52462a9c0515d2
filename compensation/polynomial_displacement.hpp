#pragma once

#include "compensation/compensator.hpp"
#include "compensation/delay_adaptive.hpp"
#include "compensation/polynomial_extrapolation.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// Polynomial extrapolation of the target displacement (Horiuchi, Inoue, Konno and Namita,
/// Earthquake Engng Struct. Dyn. 28, 1999; there order 3 and points spaced by the delay).
///
/// The polynomial of `order` through order + 1 targets, the newest one and those 1, 2, …
/// point spacings T ago, evaluated `delay` ahead of the newest:
///
///     command(t) = sum over j of w_j target(t - j T)
///     w_j = product over l != j of (s + l) / (l - j),   s = delay / T
///
/// Exact for motions that are polynomials of that order, the identity at zero delay; amplifies
/// noise by noise_gain(). Wide spacing is quiet, but follows fast motion less well.
///
/// Until `order` spacings have passed since the first target, the order is what the history
/// allows, 0 (command = target) during the first spacing.
class PolynomialDisplacement final : public Compensator, public DelayAdaptive {
 public:
  using Parameters = PolynomialParameters;
  static constexpr int kMaxOrder = kMaxPolynomialOrder;
  static constexpr int kMaxSpacingsAhead = PolynomialExtrapolation::kMaxSpacingsAhead;

  /// @param control_period_s   [s] command() is called once in each.
  /// @throws ConfigError for values outside the ranges of PolynomialParameters.
  PolynomialDisplacement(const Parameters& parameters, double control_period_s)
      : extrapolation_{parameters, control_period_s} {}
  /// The same in whole nanoseconds.
  PolynomialDisplacement(int order, Duration delay, Duration control_period, Duration point_spacing = Duration::zero())
      : PolynomialDisplacement{{order, to_seconds(delay), to_seconds(point_spacing)}, to_seconds(control_period)} {}

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override {
    return extrapolation_.advance(input.target_m);
  }
  void reset() noexcept override { extrapolation_.reset(); }

  /// The point spacing stays.
  void set_delay(double delay_s) noexcept override { extrapolation_.set_delay(delay_s); }
  [[nodiscard]] double delay_s() const noexcept override { return extrapolation_.delay_s(); }
  [[nodiscard]] double delay_s_max() const noexcept override { return extrapolation_.delay_s_max(); }
  [[nodiscard]] double point_spacing_s() const noexcept { return extrapolation_.point_spacing_s(); }
  /// Sum of |w_j| at full order: the most by which a bounded error of the targets can grow.
  [[nodiscard]] double noise_gain() const noexcept { return extrapolation_.noise_gain(); }

 private:
  PolynomialExtrapolation extrapolation_;
};

}  // namespace hybridtest
