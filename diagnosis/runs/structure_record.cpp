#include "diagnosis/runs/structure_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/config_error.hpp"
#include "diagnosis/runs/coordinator_record.hpp"
#include "recording/error.hpp"
#include "recording/run_file_reader.hpp"
#include "runtime/participant.hpp"
#include "runtime/run_directory.hpp"
#include "scenario/catalogue/integrators.hpp"

namespace hybridtest {
namespace {

/// Shares of a ground motion's root mean square below which two are the same, written with other digits.
constexpr double kSameMotion = 1e-9;

void require_same_test(const Scenario& scenario, const Scenario& ran) {
  const std::string what = scenario.file.string() + ": not the test that was recorded: ";
  if (scenario.dofs != ran.dofs) throw ConfigError{what + "the degrees of freedom have other names or another order"};
  const bool same = std::ranges::equal(scenario.substructures, ran.substructures, [](const auto& a, const auto& b) {
    return a.id == b.id && a.role == b.role && a.interface_names == b.interface_names;
  });
  if (!same) throw ConfigError{what + "the substructures or their interfaces differ"};
}

/// Velocity that a command carries: from the step before, with its acceleration kept. One column per step.
Eigen::MatrixXd commanded_velocity_m_per_s(const RunFileReader& coordinator, const Scenario& scenario,
                                           const TestResponse& response, double step_s) {
  Eigen::MatrixXd velocity = Eigen::MatrixXd::Zero(response.displacement_m.rows(), response.steps());
  for (Eigen::Index dof = 0; dof < velocity.rows(); ++dof) {
    const std::vector<double> acceleration =
        coordinator.column("steps", "acceleration_" + scenario.dofs[static_cast<std::size_t>(dof)] + "_m_per_s2");
    for (Eigen::Index i = 1; i < velocity.cols(); ++i) {
      velocity(dof, i) = response.velocity_m_per_s(dof, i - 1) + step_s * acceleration[static_cast<std::size_t>(i - 1)];
    }
  }
  return velocity;
}

/// What a numerical substructure answered, one column per step; nothing where a step is missing.
std::optional<Eigen::MatrixXd> recorded_forces(const RunFileReader& file, const SubstructureScenario& substructure,
                                               Eigen::Index steps) {
  Eigen::MatrixXd forces_n(substructure.interface.size(), steps);
  const std::vector<double> numbers = file.column("steps", "step");
  if (std::ssize(numbers) < steps) return {};
  for (Eigen::Index i = 0; i < steps; ++i) {
    if (numbers[static_cast<std::size_t>(i)] != static_cast<double>(i)) return {};
  }
  for (Eigen::Index k = 0; k < forces_n.rows(); ++k) {
    const std::string& name = substructure.interface_names[static_cast<std::size_t>(k)];
    const std::vector<double> values = file.column("steps", "force_" + name + "_n");
    forces_n.row(k) = Eigen::Map<const Eigen::RowVectorXd>{values.data(), steps};
  }
  return forces_n;
}

/// Forces of the numerical substructures, recorded and modelled; left out where one has no record.
void add_numerical_forces(const std::filesystem::path& run, const Scenario& scenario, const Eigen::MatrixXd& velocity,
                          StructureRecord& record) {
  StructureRecording& recording = record.recording;
  Eigen::MatrixXd recorded_n = Eigen::MatrixXd::Zero(recording.displacement_m.rows(), recording.steps());
  Eigen::MatrixXd modelled_n = recorded_n;
  for (const SubstructureScenario& substructure : scenario.substructures) {
    if (substructure.role != Role::numerical_substructure) continue;
    std::optional<Eigen::MatrixXd> forces_n;
    if (std::filesystem::exists(run_file(run, substructure.id))) {
      forces_n = recorded_forces(RunFileReader{run_file(run, substructure.id)}, substructure, recording.steps());
    }
    if (!forces_n) {
      record.notes.push_back("The forces of " + substructure.id + " are not all in " + run.string() +
                             ": the stiffness of numerical substructures is not judged.");
      return;
    }
    const auto model = substructure.make_model();
    model->reset();
    const InterfaceMap& interface = substructure.interface;
    InterfaceVector displacement_m;
    InterfaceVector velocity_m_per_s;
    InterfaceVector force_n = InterfaceVector::Zero(interface.size());
    for (Eigen::Index i = 0; i < recording.steps(); ++i) {
      interface.to_interface(recording.displacement_m.col(i), displacement_m);
      interface.to_interface(velocity.col(i), velocity_m_per_s);
      model->trial(displacement_m, velocity_m_per_s, force_n);
      model->commit();
      interface.add_to_structure(force_n, modelled_n.col(i));
      interface.add_to_structure(forces_n->col(i), recorded_n.col(i));
    }
  }
  recording.numerical_force_n = std::move(recorded_n);
  recording.modelled_numerical_force_n = std::move(modelled_n);
}

/// What of the configuration differs that no effect stands for.
void note_differences(const Scenario& scenario, const Scenario& ran, const Eigen::RowVectorXd& ground_m_per_s2,
                      std::vector<std::string>& notes) {
  if (scenario.integrator_type != ran.integrator_type) {
    notes.push_back(fmt::format("The scenario integrates by {}, the test was by {}.", scenario.integrator_type,
                                ran.integrator_type));
  }
  if (scenario.time.step_s != ran.time.step_s) {
    notes.push_back(
        fmt::format("The scenario's step is {} s, that of the test {} s.", scenario.time.step_s, ran.time.step_s));
    return;
  }
  const auto steps = std::min<Eigen::Index>(ground_m_per_s2.size(), std::ssize(scenario.ground_acceleration_m_per_s2));
  const Eigen::Map<const Eigen::RowVectorXd> own{scenario.ground_acceleration_m_per_s2.data(), steps};
  const double off = (own - ground_m_per_s2.head(steps)).norm();
  if (off > kSameMotion * ground_m_per_s2.norm()) {
    notes.push_back(
        fmt::format("The scenario's ground motion is not the one of the test: they differ by {:.3g} of its root mean "
                    "square. The one that was recorded is taken.",
                    off / ground_m_per_s2.norm()));
  }
}

}  // namespace

StructureRecord structure_record(const std::filesystem::path& run, const Scenario& scenario) {
  const Scenario ran = read_scenario(run / "scenario.yaml", {});
  require_same_test(scenario, ran);
  const RunFileReader coordinator{run_file(run, kCoordinatorId)};
  const TestResponse response = recorded_response(run, ran);
  if (response.steps() == 0) throw RecordingError{run.string() + ": the coordinator completed no step"};
  StructureRecord record;
  record.model.structure = scenario.structure;
  record.model.step_s = scenario.integrator_step_s;
  record.model.make_integrator = [type = scenario.integrator_type](const LinearStructure& structure, double step_s) {
    return make_integrator(type, structure, step_s);
  };
  const std::vector<double> ground = coordinator.column("steps", "ground_acceleration_m_per_s2");
  record.recording.step_s = ran.time.step_s;
  record.recording.ground_m_per_s2 = Eigen::Map<const Eigen::RowVectorXd>{ground.data(), std::ssize(ground)};
  record.recording.displacement_m = response.displacement_m;
  record.recording.restoring_force_n = response.restoring_force_n;
  note_differences(scenario, ran, record.recording.ground_m_per_s2, record.notes);
  add_numerical_forces(run, scenario, commanded_velocity_m_per_s(coordinator, ran, response, ran.integrator_step_s),
                       record);
  return record;
}

}  // namespace hybridtest
