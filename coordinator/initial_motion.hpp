#pragma once

#include <Eigen/Core>

#include "coordinator/integrator.hpp"
#include "mechanics/structure/linear_structure.hpp"

namespace hybridtest {

/// Where the structure starts from; empty vectors stand for rest.
struct InitialMotion {
  Eigen::VectorXd displacement_m;
  Eigen::VectorXd velocity_m_per_s;
};

/// The motion at step 0, its acceleration zero until the first restoring force is known.
/// @throws ConfigError when sizes differ from `size` or numbers are not finite.
[[nodiscard]] MotionState starting_state(const InitialMotion& initial, Eigen::Index size);

/// Passes the structure on, so that it is checked before anything is factorised.
/// @throws ConfigError unless `step_s` is a positive finite number; as require_consistent().
const LinearStructure& require_integrable(const LinearStructure& structure, double step_s);

}  // namespace hybridtest
