#pragma once

#include "compensation/force_compensator.hpp"
#include "compensation/quadratic_fit.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Force correction as published (founding study, figure 4; Ahmadizadeh, Mosqueda and Reinhorn, 2006):
/// quadratics through the last few measured displacements and forces,
///
///     x(t) = p0 + p1 t + p2 t^2,   f(t) = q0 + q1 t + q2 t^2,   t = 0 now,
///     x(t*) = desired displacement,   force = f(t*).
///
/// Of two real roots the one nearest to now counts; where the roots are complex (the desired
/// displacement lies beyond the vertex) the uncorrected force is used. That rule makes the jumps of the
/// study's figure 13, and the method is kept for the record; ForceCorrection does without them.
///
/// Exact where displacement and force are quadratics in time and the root nearest to now is the right
/// one; the identity where the desired displacement is the measured one. The study gives neither the
/// number of points nor their spacing, nor which of two real roots: those are an interpretation.
class ForceCorrectionQuadratic final : public ForceCompensator {
 public:
  struct Parameters {
    int points = 3;
    double point_spacing_s = 0.020;

    void serialize(ParameterArchive& archive) {
      archive.optional("points", points,
                       {{.low = 3.0, .high = 100.0},
                        "that the quadratic goes through; of more than 3 by least squares",
                        "a quadratic has three coefficients"});
      archive.optional("point_spacing_s", point_spacing_s,
                       {{.low = 0.0, .high = 1.0, .low_open = true},
                        "between them, rounded to control periods",
                        "the motion is a quadratic for no longer",
                        "1 control period to 1"});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  ForceCorrectionQuadratic(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double corrected_force(const ForceSample& sample) noexcept override;
  void reset() noexcept override;

 private:
  QuadraticFit fit_;
  SampleHistory displacements_m_;
  SampleHistory forces_n_;
};

}  // namespace hybridtest
