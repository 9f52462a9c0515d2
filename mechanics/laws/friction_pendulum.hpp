#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/law.hpp"
#include "mechanics/laws/presliding_element.hpp"

namespace hybridtest {

/// Sliding isolator on a spherical dish under a constant weight W (Zayas, Low and Mahin, Earthquake Spectra 6, 1990)
/// with friction that grows with the velocity (Constantinou, Mokha and Reinhorn, J. Struct. Eng. 116, 1990):
///
///     F = W x / R + mu(v) W z,    mu(v) = mu_fast - (mu_fast - mu_slow) exp(-a |v|)
///
/// with the share z of the friction that acts: elastoplastic, of stiffness mu_fast W over the pre-sliding displacement,
/// see PreslidingElement. As VelDependent friction on singleFPSimple of OpenSees; the rise of the dish, of the order of
/// (x / R)^2, is left out.
class FrictionPendulum final : public Law {
 public:
  struct Parameters {
    double weight_n = 0.0;                // W
    double radius_m = 0.0;                // R
    double friction_coefficient = 0.0;    // mu_fast
    double slow_friction_ratio = 1.0;     // mu_slow / mu_fast
    double friction_rate_s_per_m = 50.0;  // a
    double presliding_displacement_m = 0.0005;

    void serialize(ParameterArchive& archive) {
      archive.required("weight_n", weight_n, {kPositive, "W, vertical load, constant"});
      archive.required("radius_m", radius_m, {kPositive, "R, of curvature, from dish to slider"});
      archive.required("friction_coefficient", friction_coefficient, {kNotNegative, "mu at high velocity"});
      archive.optional("slow_friction_ratio", slow_friction_ratio,
                       {kZeroToOne, "mu at low velocity over that at high velocity; 1: the same"});
      archive.optional("friction_rate_s_per_m", friction_rate_s_per_m,
                       {kNotNegative, "a, the larger, the sooner mu is that of high velocity"});
      archive.optional("presliding_displacement_m", presliding_displacement_m,
                       {kPositive, "from rest until it slides"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit FrictionPendulum(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_ = trial_; }
  void revert() noexcept override { trial_ = committed_; }
  void reset() noexcept override;
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;

 private:
  Parameters parameters_;
  PreslidingElement committed_;
  PreslidingElement trial_;
};

}  // namespace hybridtest
