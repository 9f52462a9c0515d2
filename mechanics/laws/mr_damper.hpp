#pragma once

#include "core/parameters/parameter_archive.hpp"
#include "mechanics/laws/hysteretic_element.hpp"
#include "mechanics/laws/law.hpp"

namespace hybridtest {

/// Magnetorheological damper at one constant current: the Bouc-Wen model of Spencer, Dyke, Sain and Carlson (J. Eng.
/// Mech. 123, 1997, equations 4 and 5),
///
///     F = c v + k x + Fh z
///
/// with z of HystereticElement (their exponent 2). Their modified model, with a second dashpot in series that rounds
/// the force near zero velocity, is a differential equation in time; a law is handed displacement and velocity alone.
/// Another current is another set of parameters: c and Fh grow with it.
class MrDamper final : public Law {
 public:
  struct Parameters {
    double damping_n_s_per_m = 0.0;          // c
    double stiffness_n_per_m = 0.0;          // k
    double hysteretic_force_n = 0.0;         // Fh
    double hysteretic_displacement_m = 0.0;  // xh

    void serialize(ParameterArchive& archive) {
      archive.required("damping_n_s_per_m", damping_n_s_per_m, {kNotNegative, "c, of the fluid"});
      archive.optional("stiffness_n_per_m", stiffness_n_per_m, {kNotNegative, "k, of the accumulator"});
      archive.required("hysteretic_force_n", hysteretic_force_n, {kNotNegative, "Fh, from the magnetic field"});
      archive.required("hysteretic_displacement_m", hysteretic_displacement_m,
                       {kPositive, "xh, Fh over the slope of the hysteresis after a reversal"});
    }
  };

  /// @throws ConfigError for values outside these ranges.
  explicit MrDamper(const Parameters& parameters);

  [[nodiscard]] double trial(double displacement_m, double velocity_m_per_s) noexcept override;
  void commit() noexcept override { committed_ = trial_; }
  void revert() noexcept override { trial_ = committed_; }
  void reset() noexcept override;
  [[nodiscard]] double initial_stiffness_n_per_m() const noexcept override;

 private:
  Parameters parameters_;
  HystereticElement committed_;
  HystereticElement trial_;
};

}  // namespace hybridtest
