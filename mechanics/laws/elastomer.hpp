#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/hysteretic_element.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Filled rubber: softer below the largest displacement it has seen (Mullins effect) and softer in large motions than
/// in small ones (Payne effect).
///
///     F = eta (k x + k3 x^3) + Fp z,    eta = 1 - d erf((Wm - W) / (k xm^2 / 2)),    W = k x^2 / 2 + k3 x^4 / 4
///
/// Mullins effect by the pseudo-elasticity of Ogden and Roxburgh (Proc. R. Soc. Lond. A 455, 1999): Wm is the largest W
/// so far, and first loading is not softened. Payne effect by a rate-independent friction beside it, as Berg has it
/// (Vehicle System Dynamics 30, 1998), here with z of HystereticElement and xh = xp, which takes no more work back than
/// it was given: motions well below xp see the stiffness k + Fp / xp, large ones k alone.
class Elastomer final : public Law {
 public:
  struct Parameters {
    double stiffness_n_per_m = 0.0;        // k
    double stiffening_n_per_m3 = 0.0;      // k3
    double mullins_softening = 0.0;        // d
    double mullins_displacement_m = 0.01;  // xm
    double payne_force_n = 0.0;            // Fp
    double payne_displacement_m = 0.001;   // xp

    void serialize(ParameterArchive& archive) {
      archive.required("stiffness_n_per_m", stiffness_n_per_m, {kPositive, "k, of large motions of virgin rubber"});
      archive.optional("stiffening_n_per_m3", stiffening_n_per_m3,
                       {.range = kNotNegative, .what = "k3, with the cube of the displacement", .unit = "N/m³"});
      archive.optional("mullins_softening", mullins_softening,
                       {kZeroToBelowOne, "d, share of the force that is lost well below the largest displacement"});
      archive.optional("mullins_displacement_m", mullins_displacement_m,
                       {kPositive, "xm, largest displacement from which on most of that is lost"});
      archive.optional("payne_force_n", payne_force_n, {kNotNegative, "Fp, friction of the filler"});
      archive.optional("payne_displacement_m", payne_displacement_m, {kPositive, "xp, motion that overcomes it"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit Elastomer(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override;
  void revert() noexcept override;
  void reset() noexcept override;
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;

 private:
  Parameters parameters_;
  HystereticElement committed_filler_;
  HystereticElement trial_filler_;
  double committed_largest_j_ = 0.0;
  double trial_largest_j_ = 0.0;
};

}  // namespace hybridtest
