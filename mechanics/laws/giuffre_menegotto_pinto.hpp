#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Steel spring with a curved transition between the elastic and the hardening asymptote
/// (Menegotto and Pinto, IABSE Symposium Lisbon, 1973) after Filippou, Popov and Bertero
/// (EERC 83-19, 1983). From the last reversal (xr, Fr) on
///
///     F = Fr + k (x - xr) (b + (1 - b) / (1 + |r|^R)^(1/R)),   r = (x - xr) / (x0 - xr)
///     R = R0 (1 - cR1 xi / (cR2 + xi)),                        xi = |xp - x0| / xy
///
/// where x0 is the displacement at which the line of stiffness k through the reversal meets the
/// hardening asymptote on the side it is heading for, xp the extreme displacement of an earlier
/// reversal on that side (at least xy), and xy = Fy / k. Isotropic hardening moves that asymptote out by the factor
///
///     1 + a1 ((xmax - xmin) / (2 a2 xy))^0.8 on the negative side, likewise with a3 and a4 on the positive one
///
/// with the extreme displacements xmax and xmin of earlier reversals; first loading has none. Branches change at
/// reversals of the displacement against the committed one, as in Steel02 of OpenSees.
///
/// A known property of the law: after a small unloading it reloads on a new curve and can exceed
/// the curve it left. ignore_reversals_within() keeps it on that curve.
class GiuffreMenegottoPinto final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;
    double yield_force_n = 0.0;
    double hardening_ratio = 0.0;  // b
    double r0 = 20.0;
    double cr1 = 0.925;
    double cr2 = 0.15;
    double a1 = 0.0;
    double a2 = 1.0;
    double a3 = 0.0;
    double a4 = 1.0;

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "before yielding"});
      archive.required("yield_force_n", yield_force_n, {kPositive});
      archive.required("hardening_ratio", hardening_ratio,
                       {kBelowOneEitherWay,
                        "stiffness after yielding over stiffness before; negative: softens, as under an axial load"});
      archive.optional("r0", r0, {{.low = 0.0, .high = 100.0, .low_open = true}, "R0, curvature of the first branch"});
      archive.optional("cr1", cr1, {kZeroToBelowOne, "cR1, loss of curvature"});
      archive.optional("cr2", cr2, {kPositive, "cR2, displacement of half that loss"});
      archive.optional("a1", a1, {kNotNegative, "isotropic hardening in compression"});
      archive.optional("a2", a2, {kPositive, "plastic displacement over the yield displacement that a1 refers to"});
      archive.optional("a3", a3, {kNotNegative, "isotropic hardening in tension"});
      archive.optional("a4", a4, {kPositive, "plastic displacement over the yield displacement that a3 refers to"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit GiuffreMenegottoPinto(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_ = trial_; }
  void revert() noexcept override { trial_ = committed_; }
  void reset() noexcept override { committed_ = trial_ = virgin(); }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return parameters_.stiffness_n_per_m; }
  void ignore_reversals_within(double distance_m) noexcept override { least_reversal_m_ = distance_m; }

 private:
  enum class Branch { virgin, rising, falling };

  struct State {
    Branch branch = Branch::virgin;
    double displacement_m = 0.0;  // on the branch
    double force_n = 0.0;
    double reversal_displacement_m = 0.0;
    double reversal_force_n = 0.0;
    double corner_displacement_m = 0.0;  // x0
    double curvature = 1.0;              // R
    double highest_reversal_m = 0.0;
    double lowest_reversal_m = 0.0;
  };

  [[nodiscard]] State virgin() const noexcept;
  [[nodiscard]] double hardening(const State& state, Branch branch) const noexcept;
  void begin_branch(State& state, Branch branch) const noexcept;
  [[nodiscard]] double force_n(const State& state, double displacement_m) const noexcept;

  Parameters parameters_;
  double least_reversal_m_ = 0.0;  // shorter ones are elastic and change nothing
  double yield_displacement_m_;
  State committed_;
  State trial_;
};

}  // namespace hybridtest
