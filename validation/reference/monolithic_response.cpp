#include "validation/reference/monolithic_response.hpp"

#include <fmt/format.h>

#include <memory>
#include <vector>

#include "coordinator/integrators/implicit_newmark.hpp"
#include "core/config_error.hpp"
#include "scenario/free_vibration_section.hpp"

namespace hybridtest {
namespace {

constexpr Step kProgressEvery = 1000;

/// A substructure without coupling.
struct Part {
  const InterfaceMap& interface;
  std::unique_ptr<SubstructureModel> model;
  InterfaceVector displacement_m;
  InterfaceVector velocity_m_per_s;
  InterfaceVector force_n;
};

std::vector<Part> parts_of(const Scenario& scenario) {
  std::vector<Part> parts;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (!substructure.make_reference) {
      throw ConfigError{scenario.file.string() + ": the specimen of the site '" + substructure.id +
                        "' is not known: expected a simulated rig with a law for each degree of freedom and no "
                        "`geometry`, or such a `model` beside the rig"};
    }
    const Eigen::Index dofs = substructure.interface.size();
    auto model = substructure.make_reference();
    model->start({});
    parts.push_back({substructure.interface, std::move(model), InterfaceVector::Zero(dofs), InterfaceVector::Zero(dofs),
                     InterfaceVector::Zero(dofs)});
  }
  return parts;
}

/// With the initial stiffness of the parts as they are.
LinearStructure structure_of(const Scenario& scenario, const std::vector<Part>& parts) {
  LinearStructure structure = scenario.structure;
  structure.initial_stiffness_n_per_m = structure.stiffness_n_per_m;
  if (structure.initial_stiffness_n_per_m.size() == 0) {
    structure.initial_stiffness_n_per_m.resize(structure.size(), structure.size());
  }
  for (const Part& part : parts) {
    structure.initial_stiffness_n_per_m += part.interface.on_structure(part.model->initial_stiffness_n_per_m());
  }
  return structure;
}

class MonolithicStructure {
 public:
  explicit MonolithicStructure(const Scenario& scenario)
      : parts_{parts_of(scenario)},
        structure_{structure_of(scenario, parts_)},
        load_{scenario.excitation.load(structure_)},
        step_s_{scenario.time.step_s},
        restoring_n_{Eigen::VectorXd::Zero(structure_.size())},
        ground_n_{restoring_n_},
        forces_n_{restoring_n_} {
    IntegratorReading method;
    method.make = [](const LinearStructure& structure, double step_s, const InitialMotion& initial) {
      return std::make_unique<ImplicitNewmark>(ImplicitNewmark::Parameters{}, structure, step_s, initial);
    };
    integrator_ = begun_integrator(method, scenario.excitation.free_vibration, structure_, step_s_);
  }

  /// Completes the step. @return its displacement.
  [[nodiscard]] const Eigen::VectorXd& complete(Step step) {
    load_.ground_at(step, ground_n_);
    if (load_.has_forces()) load_.forces_at(step, forces_n_);
    for (bool was_trial = true; was_trial;) {
      was_trial = integrator_->is_trial();
      try_parts();
      integrator_->advance(restoring_n_, ground_n_ + forces_n_);
      if (const double missing_m = integrator_->missing_m(); missing_m != 0.0) {
        throw ConfigError{fmt::format(
            "the reference has no equilibrium at {:.6g} s: the last of {} trials was corrected by {:.3g} m; shorten "
            "time.step_s",
            static_cast<double>(step) * step_s_, integrator_->iteration(), missing_m)};
      }
    }
    for (Part& part : parts_) part.model->commit();
    is_tried_ = false;
    return integrator_->completed().displacement_m;
  }

 private:
  /// Forces at the current command, from the state at the end of the step before.
  void try_parts() {
    const MotionState& motion = integrator_->current();
    restoring_n_.setZero();
    for (Part& part : parts_) {
      if (is_tried_) part.model->revert();
      part.interface.to_interface(motion.displacement_m, part.displacement_m);
      part.interface.to_interface(motion.velocity_m_per_s, part.velocity_m_per_s);
      part.model->trial(part.displacement_m, part.velocity_m_per_s, part.force_n);
      part.interface.add_to_structure(part.force_n, restoring_n_);
    }
    is_tried_ = true;
    if (structure_.stiffness_n_per_m.nonZeros() > 0)
      restoring_n_ += structure_.stiffness_n_per_m * motion.displacement_m;
  }

  std::vector<Part> parts_;
  LinearStructure structure_;
  AppliedLoad load_;
  double step_s_;
  std::unique_ptr<Integrator> integrator_;
  bool is_tried_ = false;
  Eigen::VectorXd restoring_n_;
  Eigen::VectorXd ground_n_;
  Eigen::VectorXd forces_n_;
};

}  // namespace

ReferenceResponse monolithic_response(const Scenario& scenario, const std::function<void(Step, Step)>& progress) {
  if (scenario.opensees) {
    throw ConfigError{scenario.file.string() +
                      ": OpenSees leads this test, and its model of the structure is not known here; compute the same "
                      "model without a test in OpenSees itself"};
  }
  MonolithicStructure test{scenario};
  const Step last = scenario.time.last_step;
  ReferenceResponse response{.step_s = scenario.time.step_s,
                             .displacement_m = Eigen::MatrixXd{scenario.structure.size(), last + 1}};
  for (Step step = 0; step <= last; ++step) {
    response.displacement_m.col(step) = test.complete(step);
    if (progress && (step % kProgressEvery == 0 || step == last)) progress(step, last);
  }
  return response;
}

}  // namespace hybridtest
