#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Flag-shaped spring that comes back to zero: post-tensioned rocking walls and joints, shape memory alloys, friction
/// spring dampers (Christopoulos, Filiatrault and Folz, Earthquake Engng Struct. Dyn. 31, 2002).
///
///     F = k (x - (1 - b) xs),    (1 - beta) xa <= x - xs <= xa,    xa = Fa / k
///
/// on the positive side, with the slip xs >= 0 as its only history; the negative side is alike. The lower limit ends
/// where xs is zero: then the spring is elastic through the origin, and nothing remains without force. It unloads with
/// k over a drop of beta Fa and follows the lower line of the flag back. The return to the limits is exact for any
/// increment. A negative b is a wall or a column that rocks: its own weight pushes it on. SelfCentering of OpenSees
/// (without its slip and bearing) keeps the limits of the last step instead and agrees for small steps.
class SelfCentring final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;   // k
    double activation_force_n = 0.0;  // Fa
    double hardening_ratio = 0.0;     // b
    double flag_ratio = 0.0;          // beta

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "before activation"});
      archive.required("activation_force_n", activation_force_n,
                       {kPositive, "where the gap opens or the alloy transforms"});
      archive.required("hardening_ratio", hardening_ratio,
                       {kBelowOneEitherWay,
                        "stiffness after activation over stiffness before; negative: softens, as a wall that rocks"});
      archive.required("flag_ratio", flag_ratio,
                       {kZeroToOne, "beta, height of the flag over the activation force; 0: no energy is dissipated"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit SelfCentring(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_slip_m_ = trial_slip_m_; }
  void revert() noexcept override { trial_slip_m_ = committed_slip_m_; }
  void reset() noexcept override { committed_slip_m_ = trial_slip_m_ = 0.0; }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return parameters_.stiffness_n_per_m; }

 private:
  Parameters parameters_;
  double upper_m_;  // largest x - xs on the positive side
  double lower_m_;  // smallest, where xs is not 0
  double committed_slip_m_ = 0.0;
  double trial_slip_m_ = 0.0;
};

}  // namespace hybridtest
