#pragma once

#include <cstddef>

#include "compensation/force_compensator.hpp"
#include "compensation/quadratic_fit.hpp"
#include "compensation/sample_history.hpp"
#include "core/parameters/parameter_archive.hpp"

namespace hybridtest {

/// Force correction without jumps: the founding study's method (force_correction_quadratic.hpp) made
/// usable. Ours.
///
///     x(t), f(t)   quadratics of measured displacement and force, t = 0 now
///     t*           follows the root of x(t) = desired displacement
///     force = f(t*) + k_s (desired displacement - x(t*))
///
/// 1. Fit. Least squares over a window of all samples, so that sensor noise does not turn into
///    curvature. The desired displacement is fitted likewise, for its direction.
/// 2. Choice of root. A parabola meets a level twice, on the way out and on the way back. The root
///    that counts is the one at which the fitted displacement goes the way the desired one goes; the
///    root nearest to now, as published, is the wrong one while the peak is nearer than the delay.
///    Where both are real they differ only in that; they meet in the vertex before they turn complex.
/// 3. Fallback. Where the roots are complex, the vertex: the nearest that the parabola comes. Roots are
///    moved to within the window backwards and a horizon ahead.
/// 4. No jumps. t* follows the wanted root no faster than a rate, and what its displacement then misses
///    of the desired one is made up with the secant stiffness k_s of the last second (least squares of
///    force on displacement, prior first). Both terms are continuous in t* and in the fits, so that the
///    force moves, from one sample to the next, no further than the fits and rate T (f' - k_s x') do.
///
/// Exact where displacement and force are quadratics in time and t* has arrived; and, without any root,
/// for a linear elastic specimen of stiffness k_s. The identity where the desired displacement is the
/// measured one and the signals are quadratics. A non-finite sample stops learning and moves no t*.
class ForceCorrection final : public ForceCompensator {
 public:
  struct Parameters {
    double window_s = 0.030;
    double horizon_s = 0.050;
    double root_rate_s_per_s_max = 1.0;
    double stiffness_n_per_m = 1e6;
    double stiffness_memory_s = 1.0;
    double prior_motion_m = 3e-4;

    void serialize(ParameterArchive& archive) {
      constexpr const char* kSpan = "the motion is a quadratic for no longer";
      archive.optional("window_s", window_s,
                       {{.low = 0.0, .high = 1.0, .low_open = true}, "of the fits", kSpan, "3 control periods to 1"});
      archive.optional("horizon_s", horizon_s, {kZeroToOne, "furthest that is looked ahead", kSpan});
      archive.optional("root_rate_s_per_s_max", root_rate_s_per_s_max,
                       {{.low = 0.0, .high = 1000.0, .low_open = true},
                        "change of the instant that is looked for",
                        "the root has to move, and without a limit it would jump"});
      archive.optional("stiffness_n_per_m", stiffness_n_per_m,
                       {{.low = 0.0, .high = 1e12},
                        "of the specimen, before anything was measured",
                        "a specimen at first resists its motion"});
      archive.optional(
          "stiffness_memory_s", stiffness_memory_s,
          {{.low = 0.01, .high = 1000.0}, "of the stiffness that is learnt", "it holds some cycles of the structure"});
      archive.optional("prior_motion_m", prior_motion_m,
                       {{.low = 1e-9, .high = 1.0},
                        "root mean square of a motion that weighs as much as the first stiffness",
                        "stiffness learnt from sensor noise is noise"});
    }
  };

  /// @throws ConfigError for values outside their ranges.
  ForceCorrection(const Parameters& parameters, double control_period_s);

  [[nodiscard]] double corrected_force(const ForceSample& sample) noexcept override;
  void reset() noexcept override;

  /// t* [s]: the delay that the correction makes up for at present.
  [[nodiscard]] double root_s() const noexcept { return root_s_; }
  /// k_s [N/m].
  [[nodiscard]] double stiffness_n_per_m() const noexcept;

 private:
  [[nodiscard]] double wanted_root(const Quadratic& displacement, const Quadratic& desired) const noexcept;
  void follow(double wanted_s) noexcept;
  void learn_stiffness(const ForceSample& sample) noexcept;

  Parameters parameters_;
  double control_period_s_;
  double keep_;  // what the stiffness remembers from one sample to the next
  QuadraticFit fit_;
  SampleHistory desired_m_;
  SampleHistory displacements_m_;
  SampleHistory forces_n_;
  double root_s_ = 0.0;
  double displacement_square_m2_s_ = 0.0;  // integrals with forgetting
  double displacement_force_n_m_s_ = 0.0;
};

}  // namespace hybridtest
