#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "coordinator/integrators/integrator.hpp"
#include "diagnosis/diagnose.hpp"
#include "mechanics/structure/linear_structure.hpp"
#include "plant/effects/effect_type.hpp"

namespace hybridtest {

/// The part of a hybrid test that the coordinator computes, as described by the scenario of the user.
struct ComputedStructure {
  LinearStructure structure;
  Eigen::MatrixXd influence;  // iota of each ground motion, one column each
  double step_s = 0.0;        // of the integrator
  std::function<std::unique_ptr<Integrator>(const LinearStructure& structure, double step_s)> make_integrator;
};

/// Input and output of that part in a test: one column per step; rows are degrees of freedom of the
/// structure, positive as displacements are.
struct StructureRecording {
  double step_s = 0.0;                // of the test
  Eigen::MatrixXd ground_m_per_s2;    // acceleration, a row for each ground motion
  Eigen::MatrixXd forces_n;           // applied besides; without columns where there are none
  Eigen::MatrixXd displacement_m;     // commanded
  Eigen::MatrixXd restoring_force_n;  // of all substructures, as received, and of the elastic part
  // Of the elastic part and the numerical substructures: as in the test, and as the user's scenario has them along
  // the recorded displacement. Both without columns where that was not recorded.
  Eigen::MatrixXd numerical_force_n;
  Eigen::MatrixXd modelled_numerical_force_n;

  [[nodiscard]] Eigen::Index steps() const noexcept { return displacement_m.cols(); }
  [[nodiscard]] bool has_numerical_forces() const noexcept { return numerical_force_n.cols() == steps(); }
};

/// The changes that the effects of the numerical substructure make: ratios, real over model, minus 1.
struct StructureErrors {
  double mass = 0.0;       // with the load of the ground motion
  double stiffness = 0.0;  // of the forces of the elastic part and the numerical substructures
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

/// The displacements recomputed with the same integrator over the whole recording, using the recorded forces (not
/// forces computed from its own displacements). With the structure of the test, and without errors, they are equal to
/// the recorded ones bit for bit.
/// @throws ConfigError as the integrator, for ratios that leave no mass.
[[nodiscard]] Eigen::MatrixXd recomputed_displacement_m(const ComputedStructure& model,
                                                        const StructureRecording& recording,
                                                        const StructureErrors& errors = {});

/// An error of the structure with what the record says of it.
struct FittedRatio {
  const StructureEffect* effect = nullptr;
  double value = 0.0;
  double standard_error = 0.0;  // of a remainder as correlated as it is (independent_samples())
  bool at_bound = false;        // of the effect's search range
};

struct StructureFit {
  std::vector<FittedRatio> ratios;
  double nrmse = 0.0;  // of the recomputed displacements, over that of the recorded ones

  [[nodiscard]] StructureErrors errors() const;
};

/// Ratios that fit the recomputed displacements to the recorded ones, by least squares over the whole
/// recording and every degree of freedom, within the effects' search ranges. Gauss-Newton with differences of 1e-6,
/// halved while it does not descend.
/// @param start   the effects to fit, and from where.
[[nodiscard]] StructureFit fit_structure(const ComputedStructure& model, const StructureRecording& recording,
                                         std::vector<FittedRatio> start);

/// Whether the structure of a scenario gives the displacements that were commanded, and if not, which of its
/// numbers is wrong.
struct StructureDiagnosis {
  double nrmse = 0.0;        // of the displacements recomputed with the scenario as given
  double floor_nrmse = 0.0;  // rounding: of every step, integrated twice as a random walk, steps^1.5 / 2^53
  report::Verdict verdict = report::Verdict::none;  // none, named or unknown
  StructureFit fit;                                 // the causes; none in it for none and unknown
  std::vector<double> shares;                       // one per cause: of what they explain
  double gap_left = 1.0;                            // share of the gap's energy that the causes leave
};

/// Effects are selected one by one, the best first, as long as each reduces the gap clearly. Computed signals have
/// no noise: a correct set of ratios leaves only rounding. Several wrong ratios together can explain most of a gap;
/// they are not named.
[[nodiscard]] StructureDiagnosis diagnose_structure(const ComputedStructure& model,
                                                    const StructureRecording& recording);

/// Adds the interface `numerical_substructure` to the diagnosis of a site: its entry, its causes, and the combined
/// verdict. Its effects are not added to Diagnosis::causes, which belong to the model of the site.
void add_structure(const StructureDiagnosis& structure, Diagnosis& diagnosis);

/// The causes as effects of a scenario.
[[nodiscard]] std::vector<EffectSetting> causes_of(const StructureDiagnosis& structure);

}  // namespace hybridtest
