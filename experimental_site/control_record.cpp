#include "experimental_site/control_record.hpp"

#include <string>

namespace hybridtest {
ControlRecord::ControlRecord(int dofs, RowSink& sink) : sink_{sink}, row_(layout(dofs).columns.size()) {}

void ControlRecord::append(const ControlSample& sample) noexcept {
  std::size_t next = 0;
  row_[next++] = static_cast<double>(sample.sample);
  row_[next++] = sample.time_s;
  row_[next++] = sample.model_time_s;
  for (Eigen::Index k = 0; k < sample.target_displacement_m.size(); ++k) {
    row_[next++] = sample.target_displacement_m[k];
    row_[next++] = sample.command_displacement_m[k];
    row_[next++] = sample.measured_displacement_m[k];
    row_[next++] = sample.measured_force_n[k];
    row_[next++] = sample.compensated_force_n[k];
  }
  row_[next++] = sample.energy_error_j;
  row_[next++] = sample.tracking_lag_sine;
  row_[next++] = static_cast<double>(static_cast<std::uint32_t>(sample.faults));
  for (const double velocity_m_per_s : sample.target_velocity_m_per_s) row_[next++] = velocity_m_per_s;
  row_[next++] = sample.energy_error_ratio;
  row_[next++] = sample.command_age_s;
  row_[next++] = sample.follows_targets ? 1.0 : 0.0;
  sink_.append(row_);
}

TableLayout ControlRecord::layout(int dofs) {
  TableLayout layout{"control", {{"sample", ""}, {"time_s", "s"}, {"model_time_s", "s"}}};
  for (int k = 1; k <= dofs; ++k) {
    const std::string suffix = column_suffix(k, dofs);
    layout.columns.push_back({"target_displacement_m" + suffix, "m"});
    layout.columns.push_back({"command_displacement_m" + suffix, "m"});
    layout.columns.push_back({"measured_displacement_m" + suffix, "m"});
    layout.columns.push_back({"measured_force_n" + suffix, "N"});
    layout.columns.push_back({"compensated_force_n" + suffix, "N"});
  }
  layout.columns.push_back({"energy_error_j", "J"});
  layout.columns.push_back({"tracking_lag_sine", ""});
  layout.columns.push_back({"faults", ""});
  for (int k = 1; k <= dofs; ++k) {
    layout.columns.push_back({"target_velocity_m_per_s" + column_suffix(k, dofs), "m/s"});
  }
  layout.columns.push_back({"energy_error_ratio", ""});
  layout.columns.push_back({"command_age_s", "s"});
  layout.columns.push_back({"follows_targets", ""});
  return layout;
}

}  // namespace hybridtest
