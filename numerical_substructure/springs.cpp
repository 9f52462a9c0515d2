#include "numerical_substructure/springs.hpp"

#include <string>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"

namespace hybridtest {

Springs::Springs(std::vector<std::unique_ptr<Law>> laws) : laws_{std::move(laws)} {
  if (laws_.empty() || laws_.size() > kMaxInterfaceDofs) {
    throw ConfigError{std::to_string(laws_.size()) + " springs; expected 1 to " + std::to_string(kMaxInterfaceDofs) +
                      ", one per interface degree of freedom"};
  }
  for (const auto& law : laws_) HYBRIDTEST_ASSERT(law != nullptr);
}

void Springs::trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
                    InterfaceVector& force_n) noexcept {
  HYBRIDTEST_ASSERT(displacement_m.size() == interface_dofs());
  HYBRIDTEST_ASSERT(velocity_m_per_s.size() == interface_dofs());
  HYBRIDTEST_ASSERT(force_n.size() == interface_dofs());
  for (Eigen::Index i = 0; i < force_n.size(); ++i)
    force_n[i] = laws_[static_cast<std::size_t>(i)]->trial(displacement_m[i], velocity_m_per_s[i]);
}

void Springs::commit() noexcept {
  for (const auto& law : laws_) law->commit();
}

void Springs::revert() noexcept {
  for (const auto& law : laws_) law->revert();
}

void Springs::reset() noexcept {
  for (const auto& law : laws_) law->reset();
}

InterfaceMatrix Springs::initial_stiffness_n_per_m() const {
  InterfaceMatrix stiffness = InterfaceMatrix::Zero(interface_dofs(), interface_dofs());
  for (Eigen::Index i = 0; i < stiffness.rows(); ++i)
    stiffness(i, i) = laws_[static_cast<std::size_t>(i)]->initial_stiffness_n_per_m();
  return stiffness;
}

}  // namespace hybridtest
