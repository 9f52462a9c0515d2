#include "diagnosis/runs/coordinator_record.hpp"

#include "recording/run_file_reader.hpp"
#include "runtime/participant.hpp"
#include "runtime/run_directory.hpp"

namespace hybridtest {

TestResponse recorded_response(const std::filesystem::path& run, const Scenario& scenario) {
  const RunFileReader coordinator{run_file(run, kCoordinatorId)};
  return response_of_steps(scenario, [&](const std::string& name) { return coordinator.column("steps", name); });
}

TestResponse response_of_steps(const Scenario& scenario,
                               const std::function<std::vector<double>(const std::string&)>& column) {
  TestResponse response;
  response.step_s = scenario.time.step_s;
  const auto row_of = [&](const std::string& name) {
    const std::vector<double> values = column(name);
    return Eigen::RowVectorXd{Eigen::Map<const Eigen::RowVectorXd>{values.data(), std::ssize(values)}};
  };
  const Eigen::RowVectorXd ground_m_per_s2 = row_of("ground_acceleration_m_per_s2");
  const auto dofs = std::ssize(scenario.dofs);
  for (Eigen::MatrixXd* signal : {&response.displacement_m, &response.velocity_m_per_s, &response.restoring_force_n}) {
    signal->resize(dofs, ground_m_per_s2.size());
  }
  for (Eigen::Index i = 0; i < dofs; ++i) {
    const std::string& dof = scenario.dofs[static_cast<std::size_t>(i)];
    response.displacement_m.row(i) = row_of("displacement_" + dof + "_m");
    response.velocity_m_per_s.row(i) = row_of("velocity_" + dof + "_m_per_s");
    response.restoring_force_n.row(i) = row_of("restoring_force_" + dof + "_n");
  }
  response.applied_force_n = scenario.structure.load_per_ground_acceleration_kg() * ground_m_per_s2;
  return response;
}

}  // namespace hybridtest
