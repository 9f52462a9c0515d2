#include "experimental_site/energy_error.hpp"

#include <algorithm>

#include "core/config_error.hpp"
#include "core/message_copies.hpp"

namespace hybridtest {

EnergyErrorMonitor::EnergyErrorMonitor(SiteMatrix initial_stiffness_n_per_m, double displacement_m_min)
    : initial_stiffness_n_per_m_{std::move(initial_stiffness_n_per_m)} {
  const SiteVector smallest_m = SiteVector::Constant(initial_stiffness_n_per_m_.rows(), displacement_m_min);
  strain_energy_j_min_ = 0.5 * smallest_m.cwiseAbs2().dot(initial_stiffness_n_per_m_.diagonal().cwiseAbs());
  if (!(strain_energy_j_min_ > 0.0)) {
    throw ConfigError("initial_stiffness_n_per_m: the diagonal must not be all zero; it scales the energy error");
  }
  reset();
}

void EnergyErrorMonitor::reset() noexcept {
  energy_error_j_ = 0.0;
  ratio_ = 0.0;
  strain_energy_j_ = strain_energy_j_min_;
  has_sample_ = false;
}

void EnergyErrorMonitor::sample(const SiteVector& target_m, const SiteVector& measured_m,
                                const SiteVector& force_n) noexcept {
  const SiteVector error_m = target_m - measured_m;
  if (has_sample_) energy_error_j_ += 0.5 * (force_n + force_n_).dot(error_m - error_m_);
  has_sample_ = true;
  copy_values(error_m, error_m_);
  copy_values(force_n, force_n_);
  double strain_energy_j = 0.0;
  for (Eigen::Index row = 0; row < target_m.size(); ++row) {
    strain_energy_j += 0.5 * target_m[row] * initial_stiffness_n_per_m_.row(row).dot(target_m);
  }
  strain_energy_j_ = std::max(strain_energy_j_, strain_energy_j);
  ratio_ = energy_error_j_ / strain_energy_j_;
}

}  // namespace hybridtest
