#pragma once

#include "core/parameters/parameter_archive.hpp"
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
/// along that way by Kutta's method of third order, in substeps over which z changes by a 64th of zu, and of zeta2 near
/// the pinched range, each with what the energy in its middle leaves, to about 2e-5 of zu (at the kink where z changes
/// sign).
class BoucWenBaberNoori final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;  // k
    double alpha = 0.0;
    double n = 1.0;
    double gamma_per_m = 0.0;
    double beta_per_m = 0.0;
    double ao = 1.0;
    double strength_degradation_per_j = 0.0;   // d_nu
    double stiffness_degradation_per_j = 0.0;  // d_eta
    double pinching = 0.0;                     // zeta_s
    double pinching_rate_per_j = 0.0;          // p
    double pinching_level = 0.0;               // q
    double pinching_width_m = 1.0;             // psi
    double width_rate_m_per_j = 0.0;           // d_psi
    double width_share = 1.0;                  // lambda

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "k"});
      archive.required("alpha", alpha, {kZeroToOne, "share of the elastic spring"});
      archive.optional("n", n, {{.low = 1.0, .high = 100.0}, "the larger, the sharper the yielding"});
      archive.required("gamma_per_m", gamma_per_m,
                       {.what = "gamma", .values = "more than −`beta_per_m`", .unit = "1/mⁿ"});
      archive.required("beta_per_m", beta_per_m, {.range = kNotNegative, .what = "beta", .unit = "1/mⁿ"});
      archive.optional("ao", ao, {kPositive, "Ao, initial slope of z"});
      archive.optional("strength_degradation_per_j", strength_degradation_per_j, {kNotNegative, "d_nu"});
      archive.optional("stiffness_degradation_per_j", stiffness_degradation_per_j, {kNotNegative, "d_eta"});
      archive.optional("pinching", pinching, {kZeroToBelowOne, "zeta_s, share of the slope that is lost in the end"});
      archive.optional("pinching_rate_per_j", pinching_rate_per_j, {kNotNegative, "p, growth of the pinching"});
      archive.optional("pinching_level", pinching_level, {kZeroToOne, "q, z of the strongest pinching over its limit"});
      archive.optional("pinching_width_m", pinching_width_m, {kPositive, "psi, width of the pinched range of z"});
      archive.optional("width_rate_m_per_j", width_rate_m_per_j, {kNotNegative, "d_psi, growth of the width"});
      archive.optional("width_share", width_share, {kPositive, "lambda, width before any pinching over psi"});
    }
  };

  /// @param substeps_per_length   of zu and of zeta2. The error falls with its square: about 2e-5 of zu with 64, 6e-4
  ///                              with 8, enough for a search.
  /// @throws ConfigError for values outside these ranges.
  explicit BoucWenBaberNoori(const Parameters& parameters, double substeps_per_length = 64.0);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_ = trial_; }
  void revert() noexcept override { trial_ = committed_; }
  void reset() noexcept override { committed_ = trial_ = virgin_; }
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;

 private:
  /// What depends on the energy alone.
  struct Degraded {
    double strength = 1.0;    // 1 + d_nu e
    double softness = 1.0;    // 1 + d_eta e
    double ultimate_m = 0.0;  // zu
    double pinching = 0.0;    // zeta1
    double width_m = 0.0;     // zeta2
  };
  struct State {
    double displacement_m = 0.0;
    double hysteretic_m = 0.0;  // z
    double energy_j = 0.0;      // e
    Degraded degraded;          // in the middle of the last substep
  };

  [[nodiscard]] Degraded at_energy(double energy_j) const noexcept;
  /// Of the next substep at most, moving towards `direction` [m].
  [[nodiscard]] double substep_m(const State& state, double direction) const noexcept;
  /// dz / dx, moving towards `direction` (-1 or 1).
  [[nodiscard]] double slope(double hysteretic_m, double direction, const Degraded& degraded) const noexcept;
  void advance(State& state, double increment_m) const noexcept;

  Parameters parameters_;
  double substeps_per_length_;
  State virgin_;
  State committed_;
  State trial_;
};

}  // namespace hybridtest
