#include "numerical_substructure/shear_building.hpp"

#include <string>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"

namespace hybridtest {

ShearBuilding::ShearBuilding(std::vector<std::unique_ptr<Law>> storeys, Base base)
    : storeys_{std::move(storeys)}, base_{base} {
  if (storeys_.empty() || interface_dofs() > kMaxInterfaceDofs) {
    const int most = kMaxInterfaceDofs - (base == Base::first_dof ? 1 : 0);
    throw ConfigError{std::to_string(storeys_.size()) + " storeys; expected 1 to " + std::to_string(most)};
  }
  for (const auto& storey : storeys_) HYBRIDTEST_ASSERT(storey != nullptr);
}

int ShearBuilding::interface_dofs() const noexcept {
  return static_cast<int>(storeys_.size()) + (base_ == Base::first_dof ? 1 : 0);
}

void ShearBuilding::trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
                          InterfaceVector& force_n) noexcept {
  HYBRIDTEST_ASSERT(displacement_m.size() == interface_dofs());
  HYBRIDTEST_ASSERT(velocity_m_per_s.size() == interface_dofs());
  HYBRIDTEST_ASSERT(force_n.size() == interface_dofs());
  force_n.setZero();
  Eigen::Index above = base_ == Base::first_dof ? 1 : 0;
  for (const auto& storey : storeys_) {
    const Eigen::Index below = above - 1;  // -1 is the ground
    const double below_m = below < 0 ? 0.0 : displacement_m[below];
    const double below_m_per_s = below < 0 ? 0.0 : velocity_m_per_s[below];
    const double storey_n = storey->trial(displacement_m[above] - below_m, velocity_m_per_s[above] - below_m_per_s);
    force_n[above] += storey_n;
    if (below >= 0) force_n[below] -= storey_n;
    ++above;
  }
}

void ShearBuilding::commit() noexcept {
  for (const auto& storey : storeys_) storey->commit();
}

void ShearBuilding::revert() noexcept {
  for (const auto& storey : storeys_) storey->revert();
}

void ShearBuilding::reset() noexcept {
  for (const auto& storey : storeys_) storey->reset();
}

InterfaceMatrix ShearBuilding::initial_stiffness_n_per_m() const {
  InterfaceMatrix stiffness = InterfaceMatrix::Zero(interface_dofs(), interface_dofs());
  Eigen::Index above = base_ == Base::first_dof ? 1 : 0;
  for (const auto& storey : storeys_) {
    const double storey_n_per_m = storey->initial_stiffness_n_per_m();
    stiffness(above, above) += storey_n_per_m;
    if (above > 0) {
      stiffness(above - 1, above - 1) += storey_n_per_m;
      stiffness(above - 1, above) -= storey_n_per_m;
      stiffness(above, above - 1) -= storey_n_per_m;
    }
    ++above;
  }
  return stiffness;
}

}  // namespace hybridtest
