#pragma once

#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Smooth hysteresis that degrades and pinches: Bouc and Wen as extended by Baber and Wen (J. Eng. Mech.
/// Div. ASCE 107, 1981) and Baber and Noori (J. Vib. Acoust. 108, 1986), with the energy e that the
/// hysteretic part has dissipated:
///
///     F = alpha k x + (1 - alpha) k z,                     de = (1 - alpha) k z dx
///     dz = h / (1 + d_eta e) (Ao - (1 + d_nu e) (gamma + beta sign(z dx)) |z|^n) dx
///     h = 1 - zeta1 exp(-(z sign(dx) - q zu)^2 / zeta2^2)
///     zeta1 = zeta_s (1 - exp(-p e)),  zeta2 = (psi + d_psi e) (lambda + zeta1)
///     zu^n = Ao / ((1 + d_nu e) (gamma + beta)),  the limit of |z|
///
/// Rate-independent: between two exchanges x is taken to move one way, and the equation is integrated
/// along that way by the classical Runge-Kutta method in substeps of at most a 64th of zu and of
/// zeta2, to about 1e-5 of zu (at the kink where z changes sign).
class BoucWenBaberNoori final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;            // [N/m] k, positive
    double alpha = 0.0;                        // [-] share of the elastic spring, 0 to 1
    double n = 1.0;                            // [-] 1 to 100
    double gamma_per_m = 0.0;                  // [1/m^n] above -beta
    double beta_per_m = 0.0;                   // [1/m^n] not negative
    double ao = 1.0;                           // [-] positive
    double strength_degradation_per_j = 0.0;   // [1/J] d_nu, not negative
    double stiffness_degradation_per_j = 0.0;  // [1/J] d_eta, not negative
    double pinching = 0.0;                     // [-] zeta_s, 0 to less than 1
    double pinching_rate_per_j = 0.0;          // [1/J] p, not negative
    double pinching_level = 0.0;               // [-] q, 0 to 1
    double pinching_width_m = 1.0;             // [m] psi, positive
    double width_rate_m_per_j = 0.0;           // [m/J] d_psi, not negative
    double width_share = 1.0;                  // [-] lambda, positive
  };

  /// @throws ConfigError for values outside these ranges.
  explicit BoucWenBaberNoori(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_ = trial_; }
  void revert() noexcept override { trial_ = committed_; }
  void reset() noexcept override { committed_ = trial_ = State{}; }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;

 private:
  struct State {
    double displacement_m = 0.0;
    double hysteretic_m = 0.0;  // z
    double energy_j = 0.0;      // e
  };

  /// Limit of |z| with the strength that is left.
  [[nodiscard]] double ultimate_m(double energy_j) const noexcept;
  [[nodiscard]] double pinching_width_m(double energy_j, double pinching) const noexcept;
  [[nodiscard]] double pinching_at(double energy_j) const noexcept;
  /// dz / dx, moving towards `direction` (-1 or 1).
  [[nodiscard]] double slope(double hysteretic_m, double energy_j, double direction) const noexcept;
  void advance(State& state, double increment_m) const noexcept;

  Parameters parameters_;
  State committed_;
  State trial_;
};

}  // namespace hybridtest
