#include "coordinator/excitation/applied_load.hpp"

#include <algorithm>
#include <utility>

namespace hybridtest {

AppliedLoad::AppliedLoad(std::vector<GroundLoad> ground, std::vector<ForceLoad> forces)
    : ground_{std::move(ground)}, forces_{std::move(forces)} {}

bool AppliedLoad::covers(Step last_step, Eigen::Index size) const noexcept {
  const auto has_all = [&](const std::vector<double>& values) { return std::cmp_greater(values.size(), last_step); };
  return std::ranges::all_of(ground_,
                             [&](const GroundLoad& load) {
                               return has_all(load.acceleration_m_per_s2) &&
                                      load.load_per_acceleration_kg.size() == size;
                             }) &&
         std::ranges::all_of(forces_, [&](const ForceLoad& load) {
           return has_all(load.force_n) && load.factors.size() == load.dofs.size() &&
                  std::ranges::all_of(load.dofs, [&](Eigen::Index dof) { return dof >= 0 && dof < size; });
         });
}

double AppliedLoad::ground_acceleration(std::size_t ground, Step step) const noexcept {
  return ground_[ground].acceleration_m_per_s2[static_cast<std::size_t>(step)];
}

void AppliedLoad::ground_at(Step step, Eigen::Ref<Eigen::VectorXd> force_n) const noexcept {
  if (ground_.empty()) force_n.setZero();
  for (std::size_t k = 0; k < ground_.size(); ++k) {
    const auto load = ground_[k].load_per_acceleration_kg * ground_acceleration(k, step);
    if (k == 0) {
      force_n = load;
    } else {
      force_n += load;
    }
  }
}

void AppliedLoad::forces_at(Step step, Eigen::Ref<Eigen::VectorXd> force_n) const noexcept {
  force_n.setZero();
  for (const ForceLoad& load : forces_) {
    const double force = load.force_n[static_cast<std::size_t>(step)];
    for (std::size_t k = 0; k < load.dofs.size(); ++k) force_n[load.dofs[k]] += load.factors[k] * force;
  }
}

}  // namespace hybridtest
