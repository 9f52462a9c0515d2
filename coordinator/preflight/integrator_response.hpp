#pragma once

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <memory>

#include "coordinator/integrators/integrator.hpp"

namespace hybridtest {

using MakeIntegrator = std::function<std::unique_ptr<Integrator>(const LinearStructure& structure, double step_s,
                                                                 const InitialMotion& initial)>;

/// An integrator as a discrete linear system, found by stepping the integrator itself from unit states, so that no
/// equation is written twice. The structure of q coordinates answers each command with K_I u and with a force beyond
/// that, the input. The output is what the integrator commands. A step of the method holds n commands, so that the
/// system repeats itself after n commands only; its n inputs and outputs are stacked (lifted; Bittanti and Colaneri,
/// Periodic Systems, 2009, chapter 6).
class IntegratorResponse {
 public:
  static constexpr Eigen::Index kChannels = 3;  // displacement, velocity, acceleration

  /// @param structure   of unit mass. @param commands_per_step   n, of the method.
  IntegratorResponse(const MakeIntegrator& make, const LinearStructure& structure, double step_s,
                     int commands_per_step);

  /// Eigenvalues of the transition over one step of the method.
  [[nodiscard]] const Eigen::VectorXcd& poles() const noexcept { return poles_; }

  /// Transfer matrix at z per step of the method: rows (command i, channel, coordinate) in m, m/s and m/s2, columns
  /// (command j, coordinate) in m/s2.
  [[nodiscard]] Eigen::MatrixXcd at(std::complex<double> z) const;

 private:
  Eigen::MatrixXcd triangular_;  // Schur form of the transition
  Eigen::MatrixXcd input_;       // in Schur coordinates
  Eigen::MatrixXcd output_;
  Eigen::MatrixXcd direct_;  // within the step of the method
  Eigen::VectorXcd poles_;
};

/// Of one mode, by the pair of roots that vibrates.
struct NumericalMode {
  double damping_ratio = 0.0;  // -ln|z| / arg z; without physical damping that of the method alone
  double period_error = 0.0;   // (T_numerical - T) / T; NaN where nothing vibrates
};

/// @param omega_dt   of the mode and a step of the test, greater than 0.
[[nodiscard]] NumericalMode numerical_mode(const MakeIntegrator& make, int commands_per_step, double omega_dt);

}  // namespace hybridtest
