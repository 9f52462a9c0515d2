#pragma once

#include "core/interface_vector.hpp"

namespace hybridtest {

/// Hybrid simulation error monitor (Mosqueda, Stojadinovic and Mahin, 2007), as a site can
/// compute it alone: the energy that tracking errors add to the structure,
///
///   E = integral of f d(x_target) - integral of f d(x_measured)   [J], trapezoidal,
///
/// negative where the tracking error adds energy to the structure. Normalised by the
/// largest strain energy of the initial stiffness under the targets so far, 1/2 x^T K0 x, but
/// at least that of `displacement_m_min` at every degree of freedom, so that noise at rest does not
/// count as an error.
class EnergyErrorMonitor {
 public:
  EnergyErrorMonitor(SiteMatrix initial_stiffness_n_per_m, double displacement_m_min);

  void reset() noexcept;
  void sample(const SiteVector& target_m, const SiteVector& measured_m, const SiteVector& force_n) noexcept;

  [[nodiscard]] double energy_error_j() const noexcept { return energy_error_j_; }
  [[nodiscard]] double ratio() const noexcept { return ratio_; }

 private:
  SiteMatrix initial_stiffness_n_per_m_;
  double strain_energy_j_min_;
  double strain_energy_j_;
  double energy_error_j_ = 0.0;
  double ratio_ = 0.0;
  bool has_sample_ = false;
  SiteVector error_m_;
  SiteVector force_n_;
};

}  // namespace hybridtest
