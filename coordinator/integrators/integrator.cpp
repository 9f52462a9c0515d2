#include "coordinator/integrators/integrator.hpp"

#include <cmath>
#include <string>

#include "core/config_error.hpp"

namespace hybridtest {
namespace {

Eigen::VectorXd given_or_zero(const Eigen::VectorXd& given, Eigen::Index size, const std::string& name) {
  if (given.size() == 0) return Eigen::VectorXd::Zero(size);
  if (given.size() != size) {
    throw ConfigError{"the initial " + name + " has " + std::to_string(given.size()) + " entries, expected " +
                      std::to_string(size) + ", one per degree of freedom"};
  }
  if (!given.allFinite()) throw ConfigError{"the initial " + name + " holds a number that is not finite"};
  return given;
}

}  // namespace

void visit_motion(MotionState& motion, const StateVisitor& visit) {
  visit(motion.displacement_m);
  visit(motion.velocity_m_per_s);
  visit(motion.acceleration_m_per_s2);
}

MotionState starting_state(const InitialMotion& initial, Eigen::Index size) {
  return {.displacement_m = given_or_zero(initial.displacement_m, size, "displacement"),
          .velocity_m_per_s = given_or_zero(initial.velocity_m_per_s, size, "velocity"),
          .acceleration_m_per_s2 = Eigen::VectorXd::Zero(size)};
}

const LinearStructure& require_integrable(const LinearStructure& structure, double step_s) {
  if (!std::isfinite(step_s) || step_s <= 0.0) {
    throw ConfigError{"the integrator's step is " + std::to_string(step_s) + " s, expected a number greater than 0"};
  }
  require_consistent(structure);
  return structure;
}

Eigen::SparseMatrix<double> weighted_sum(const LinearStructure& structure, double mass, double damping_s,
                                         double stiffness_s2) {
  Eigen::SparseMatrix<double> sum = structure.mass_kg * mass;
  if (damping_s != 0.0) sum += structure.damping_n_s_per_m * damping_s;
  if (stiffness_s2 != 0.0) sum += structure.initial_stiffness_n_per_m * stiffness_s2;
  sum.makeCompressed();
  return sum;
}

}  // namespace hybridtest
