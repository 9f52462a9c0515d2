#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>

#include "coordinator/integrator.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "plant/effects/effect_type.hpp"

namespace hybridtest {

/// The part of a hybrid test that the coordinator computes, as the user's scenario has it.
struct ComputedStructure {
  LinearStructure structure;
  double step_s = 0.0;  // of the integrator
  std::function<std::unique_ptr<Integrator>(const LinearStructure& structure, double step_s)> make_integrator;
};

/// What that part received and made of it in a test: one column per step; rows are degrees of freedom of the
/// structure, positive as displacements are.
struct StructureRecording {
  double step_s = 0.0;                 // of the test
  Eigen::RowVectorXd ground_m_per_s2;  // acceleration
  Eigen::MatrixXd displacement_m;      // commanded
  Eigen::MatrixXd restoring_force_n;   // received, of all substructures together
  // Of the numerical substructures alone: as received, and as the user's scenario has them along the
  // recorded displacement. Both without columns where that was not recorded.
  Eigen::MatrixXd numerical_force_n;
  Eigen::MatrixXd modelled_numerical_force_n;

  [[nodiscard]] Eigen::Index steps() const noexcept { return displacement_m.cols(); }
  [[nodiscard]] bool has_numerical_forces() const noexcept { return numerical_force_n.cols() == steps(); }
};

/// What the effects of the numerical substructure change of a structure: ratios, real over model less 1.
struct StructureErrors {
  double mass = 0.0;       // with the load of the ground motion
  double stiffness = 0.0;  // of the numerical substructures' forces
  double damping = 0.0;
  double step = 0.0;  // of the integrator
};

/// A ratio and the number of the model that it corrects: that of an effect with one parameter.
struct StructureEffect {
  double StructureErrors::*ratio;
  ModelNumber number;

  [[nodiscard]] const EffectType& type() const noexcept {
    return *find_effect(EffectInterface::numerical_substructure, number);
  }
};
inline constexpr std::array kStructureEffects{StructureEffect{&StructureErrors::mass, ModelNumber::mass},
                                              StructureEffect{&StructureErrors::stiffness, ModelNumber::stiffness},
                                              StructureEffect{&StructureErrors::damping, ModelNumber::damping},
                                              StructureEffect{&StructureErrors::step, ModelNumber::step}};

/// The displacements that the structure would have commanded: the same integrator, driven over the whole record by
/// the forces that were received, not by those that its own displacements would have met. With the structure that
/// ran, and no errors, equal to those recorded bit for bit.
/// @throws ConfigError as the integrator, for ratios that leave no mass.
[[nodiscard]] Eigen::MatrixXd recomputed_displacement_m(const ComputedStructure& model,
                                                        const StructureRecording& recording,
                                                        const StructureErrors& errors = {});

}  // namespace hybridtest
