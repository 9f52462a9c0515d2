#include "numerical_substructure/spring_network.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/assert.hpp"
#include "core/config_error.hpp"

namespace hybridtest {

SpringNetwork::SpringNetwork(int interface_dofs, std::vector<Spring> springs)
    : interface_dofs_{interface_dofs}, springs_{std::move(springs)} {
  std::vector<bool> is_held(static_cast<std::size_t>(interface_dofs), false);
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    HYBRIDTEST_ASSERT(springs_[s].law != nullptr && !springs_[s].ends.empty());
    for (const Spring::End& end : springs_[s].ends) {
      HYBRIDTEST_ASSERT(end.dof >= 0 && end.dof < interface_dofs);
      is_held[static_cast<std::size_t>(end.dof)] = true;
      if (end.factor != 0.0 && std::isfinite(end.factor)) continue;
      throw ConfigError{"spring " + std::to_string(s + 1) + " has the factor " + std::to_string(end.factor) +
                        "; expected a finite number other than 0"};
    }
  }
  const auto free = std::ranges::find(is_held, false);
  if (free == is_held.end() && interface_dofs > 0) return;
  throw ConfigError{"no spring acts on degree of freedom " + std::to_string(free - is_held.begin() + 1) +
                    " of the interface; expected at least one on each"};
}

void SpringNetwork::trial(const InterfaceVector& displacement_m, const InterfaceVector& velocity_m_per_s,
                          InterfaceVector& force_n) noexcept {
  HYBRIDTEST_ASSERT(displacement_m.size() == interface_dofs_);
  HYBRIDTEST_ASSERT(velocity_m_per_s.size() == interface_dofs_);
  HYBRIDTEST_ASSERT(force_n.size() == interface_dofs_);
  force_n.setZero();
  for (const Spring& spring : springs_) {
    double elongation_m = 0.0;
    double rate_m_per_s = 0.0;
    for (const Spring::End& end : spring.ends) {
      elongation_m += end.factor * displacement_m[end.dof];
      rate_m_per_s += end.factor * velocity_m_per_s[end.dof];
    }
    const double spring_n = spring.law->trial(elongation_m, rate_m_per_s);
    for (const Spring::End& end : spring.ends) force_n[end.dof] += end.factor * spring_n;
  }
}

void SpringNetwork::commit() noexcept {
  for (const Spring& spring : springs_) spring.law->commit();
}

void SpringNetwork::revert() noexcept {
  for (const Spring& spring : springs_) spring.law->revert();
}

void SpringNetwork::reset() noexcept {
  for (const Spring& spring : springs_) spring.law->reset();
}

InterfaceMatrix SpringNetwork::initial_stiffness_n_per_m() const {
  InterfaceMatrix stiffness = InterfaceMatrix::Zero(interface_dofs_, interface_dofs_);
  for (const Spring& spring : springs_) {
    const double spring_n_per_m = spring.law->initial_stiffness_n_per_m();
    for (const Spring::End& one : spring.ends) {
      for (const Spring::End& other : spring.ends) {
        stiffness(one.dof, other.dof) += one.factor * other.factor * spring_n_per_m;
      }
    }
  }
  return stiffness;
}

SpringNetwork springs_to_ground(std::vector<std::unique_ptr<Law>> laws) {
  std::vector<Spring> springs;
  for (std::unique_ptr<Law>& law : laws) {
    const auto dof = static_cast<Eigen::Index>(springs.size());
    springs.push_back({.ends = {{.dof = dof}}, .law = std::move(law)});
  }
  const auto dofs = static_cast<int>(springs.size());
  return {dofs, std::move(springs)};
}

SpringNetwork shear_building(std::vector<std::unique_ptr<Law>> storeys, StoreyBase base) {
  std::vector<Spring> springs;
  Eigen::Index above = base == StoreyBase::first_dof ? 1 : 0;
  for (std::unique_ptr<Law>& storey : storeys) {
    std::vector<Spring::End> ends{{.dof = above}};
    if (above > 0) ends.push_back({.dof = above - 1, .factor = -1.0});
    springs.push_back({.ends = std::move(ends), .law = std::move(storey)});
    ++above;
  }
  return {static_cast<int>(above), std::move(springs)};
}

}  // namespace hybridtest
