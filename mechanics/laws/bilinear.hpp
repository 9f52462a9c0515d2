#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Bilinear spring with kinematic hardening.
///
/// An elastic spring b k beside an elastic, perfectly plastic one of stiffness (1 - b) k and
/// strength (1 - b) Fy:
///
///     F = b k x + (1 - b) k (x - xp),   |(1 - b) k (x - xp)| <= (1 - b) Fy
///
/// with the plastic displacement xp as its only history (Simo and Hughes, Computational
/// Inelasticity, 1998, section 1.4). The return to the yield surface is exact for any increment
/// of displacement. The same as Steel01 of OpenSees without isotropic hardening. A negative b softens
/// after yielding, as a column does under an axial load: b k is then what the load takes.
class Bilinear final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;
    double yield_force_n = 0.0;
    double hardening_ratio = 0.0;

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "before yielding"});
      archive.required("yield_force_n", yield_force_n, {kPositive});
      archive.required("hardening_ratio", hardening_ratio,
                       {kBelowOneEitherWay,
                        "stiffness after yielding over stiffness before; negative: softens, as under an axial load"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit Bilinear(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_plastic_m_ = trial_plastic_m_; }
  void revert() noexcept override { trial_plastic_m_ = committed_plastic_m_; }
  void reset() noexcept override { committed_plastic_m_ = trial_plastic_m_ = 0.0; }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override { return stiffness_n_per_m_; }

 private:
  double stiffness_n_per_m_;
  double hardening_stiffness_n_per_m_;
  double plastic_stiffness_n_per_m_;  // of the elastic, perfectly plastic part
  double yield_displacement_m_;
  double committed_plastic_m_ = 0.0;
  double trial_plastic_m_ = 0.0;
};

}  // namespace hybridtest
