#include "diagnosis/structure/computed_structure.hpp"

#include "core/assert.hpp"

namespace hybridtest {

Eigen::MatrixXd recomputed_displacement_m(const ComputedStructure& model, const StructureRecording& recording,
                                          const StructureErrors& errors) {
  HYBRIDTEST_ASSERT(recording.displacement_m.rows() == model.structure.size() &&
                    recording.restoring_force_n.cols() == recording.steps() &&
                    recording.ground_m_per_s2.size() == recording.steps());
  LinearStructure structure = model.structure;
  structure.mass_kg *= 1.0 + errors.mass;
  structure.damping_n_s_per_m *= 1.0 + errors.damping;
  const auto integrator = model.make_integrator(structure, model.step_s * (1.0 + errors.step));
  const Eigen::VectorXd load_kg = structure.load_per_ground_acceleration_kg();
  Eigen::MatrixXd displacement_m(recording.displacement_m.rows(), recording.steps());
  Eigen::VectorXd force_n;
  Eigen::VectorXd applied_n;
  for (Eigen::Index i = 0; i < recording.steps(); ++i) {
    displacement_m.col(i) = integrator->current().displacement_m;
    force_n = recording.restoring_force_n.col(i);
    // Where model and record agree this adds nothing at all.
    if (recording.has_numerical_forces()) {
      force_n +=
          (1.0 + errors.stiffness) * recording.modelled_numerical_force_n.col(i) - recording.numerical_force_n.col(i);
    }
    applied_n = load_kg * recording.ground_m_per_s2[i];
    integrator->advance(force_n, applied_n);
  }
  return displacement_m;
}

}  // namespace hybridtest
