#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/messages.hpp"

namespace hybridtest {

/// One ground motion as a load: each degree of freedom gets load_per_acceleration_kg times the acceleration.
struct GroundLoad {
  Eigen::VectorXd load_per_acceleration_kg;   // -M iota, positive as displacements are
  std::vector<double> acceleration_m_per_s2;  // at each step
};

/// A force that acts at some degrees of freedom, at each with a factor.
struct ForceLoad {
  std::vector<Eigen::Index> dofs;
  std::vector<double> factors;  // one per degree of freedom
  std::vector<double> force_n;  // at each step
};

/// What loads the structure in each step: the sum of all ground motions and forces. It keeps one number per step and
/// load, and for a ground motion one per degree of freedom. No product of the two.
class AppliedLoad {
 public:
  AppliedLoad() = default;
  AppliedLoad(std::vector<GroundLoad> ground, std::vector<ForceLoad> forces);

  [[nodiscard]] std::size_t ground_count() const noexcept { return ground_.size(); }
  [[nodiscard]] bool has_forces() const noexcept { return !forces_.empty(); }
  /// Every load has its values for steps 0 to last_step, and fits a structure of that size.
  [[nodiscard]] bool covers(Step last_step, Eigen::Index size) const noexcept;

  /// [m/s2]
  [[nodiscard]] double ground_acceleration(std::size_t ground, Step step) const noexcept;
  /// Sets `force_n` to the load of the ground motions. Allocates nothing.
  /// @param force_n   one entry per degree of freedom.
  void ground_at(Step step, Eigen::Ref<Eigen::VectorXd> force_n) const noexcept;
  /// Sets `force_n` to the sum of the forces. Allocates nothing.
  void forces_at(Step step, Eigen::Ref<Eigen::VectorXd> force_n) const noexcept;

 private:
  std::vector<GroundLoad> ground_;
  std::vector<ForceLoad> forces_;
};

}  // namespace hybridtest
