#pragma once

#include "compensation/compensator.hpp"
#include "compensation/polynomial_extrapolation.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Upper-bound delay (Wu, Wang and Bursi, Earthquake Engng Struct. Dyn. 42, 2013), the half on commands.
///
/// The target is extrapolated (polynomial_extrapolation.hpp) by a bound that the delay of the transfer
/// system never passes, so that the specimen reaches the target early, never late:
///
///     command(t) = sum over j of w_j target(t - j T), evaluated `delay_upper_bound` ahead
///
/// The half on forces, OptimalPick, then takes the force of the instant at which the specimen was at
/// the target. The one is of no use without the other: by itself this over-compensates.
///
/// Interpretation: the paper's abstract names the two halves; that the extrapolation is Horiuchi's
/// polynomial is ours.
class UpperBoundDelay final : public Compensator {
 public:
  struct Parameters {
    double delay_upper_bound_s = 0.024;
    int order = 3;
    double point_spacing_s = 0.0;

    void serialize(ParameterArchive& archive) {
      archive.required("delay_upper_bound_s", delay_upper_bound_s,
                       {kZeroToOne, "that the delay never passes; goes with `optimal_pick` on the forces", "",
                        "0 to 1, at most 8 point spacings"});
      archive.optional("order", order, {kPolynomialOrders, "of the polynomial"});
      archive.optional("point_spacing_s", point_spacing_s,
                       {kNotNegative, "between the points the polynomial goes through; 0: the bound", "",
                        "0, or 1 to 10 000 control periods"});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  UpperBoundDelay(const Parameters& parameters, double control_period_s)
      : extrapolation_{{parameters.order, parameters.delay_upper_bound_s, parameters.point_spacing_s},
                       control_period_s} {}

  [[nodiscard]] double command(const CompensatorInput& input) noexcept override {
    return extrapolation_.advance(input.target_m);
  }
  void reset() noexcept override { extrapolation_.reset(); }

 private:
  PolynomialExtrapolation extrapolation_;
};

}  // namespace hybridtest
