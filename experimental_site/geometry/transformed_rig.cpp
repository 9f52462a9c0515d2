#include "experimental_site/geometry/transformed_rig.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "core/assert.hpp"

namespace hybridtest {

TransformedRig::TransformedRig(std::unique_ptr<Rig> rig, std::unique_ptr<SetupGeometry> geometry, double stroke_limit_m)
    : rig_{std::move(rig)}, geometry_{std::move(geometry)}, stroke_limit_m_{stroke_limit_m} {
  HYBRIDTEST_ASSERT(rig_ != nullptr && geometry_ != nullptr && stroke_limit_m_ > 0.0);
  const SiteVector at_rest = SiteVector::Zero(geometry_->actuators());
  command_.displacement_m = at_rest;
  feedback_ = {at_rest, at_rest};
  pose_ = SiteVector::Zero(geometry_->dofs());
  row_.resize(actuators_layout(geometry_->actuators()).columns.size());
}

TableLayout TransformedRig::actuators_layout(int actuators) {
  TableLayout layout{"rig_actuators", {{"sample", "1"}}};
  for (int i = 1; i <= actuators; ++i) {
    const std::string suffix = column_suffix(i, actuators);
    layout.columns.push_back({"command_stroke_m" + suffix, "m"});
    layout.columns.push_back({"measured_stroke_m" + suffix, "m"});
    layout.columns.push_back({"measured_actuator_force_n" + suffix, "N"});
  }
  return layout;
}

void TransformedRig::record_to(const RigTables& tables) {
  actuators_record_ = &tables(actuators_layout(geometry_->actuators()).name);
  rig_->record_to(tables);
}

void TransformedRig::connect() {
  rig_->connect();
  pose_.setZero();
}

RigStatus TransformedRig::exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept {
  const auto fits = [this](const SiteVector& vector) { return vector.size() == geometry_->dofs(); };
  if (!fits(command.displacement_m) || !command.displacement_m.allFinite() || !fits(feedback.displacement_m) ||
      !fits(feedback.force_n)) {
    fault_ = RigFault::invalid_command;
    return RigStatus::fault;
  }
  command_.sample = command.sample;
  command_.time_s = command.time_s;
  geometry_->strokes(command.displacement_m, command_.displacement_m);
  const bool is_within_limit = limit_strokes();
  const RigStatus status = rig_->exchange(command_, feedback_);
  record();
  fault_.reset();
  if (status != RigStatus::healthy) return RigStatus::fault;
  fault_ = RigFault::no_pose;
  if (!find_pose(*geometry_, feedback_.displacement_m, pose_)) return RigStatus::fault;
  fault_ = RigFault::stroke_limit;
  feedback.displacement_m = pose_;
  transfer_forces(*geometry_, pose_, feedback_.force_n, feedback.force_n);
  return is_within_limit ? RigStatus::healthy : RigStatus::fault;
}

bool TransformedRig::limit_strokes() noexcept {
  bool is_within_limit = true;
  for (double& stroke_m : command_.displacement_m) {
    const double limited_m = std::clamp(stroke_m, -stroke_limit_m_, stroke_limit_m_);
    is_within_limit = is_within_limit && limited_m == stroke_m;
    stroke_m = limited_m;
  }
  return is_within_limit;
}

void TransformedRig::record() noexcept {
  if (actuators_record_ == nullptr) return;
  std::size_t next = 0;
  row_[next++] = static_cast<double>(command_.sample);
  for (Eigen::Index i = 0; i < geometry_->actuators(); ++i) {
    row_[next++] = command_.displacement_m[i];
    row_[next++] = feedback_.displacement_m[i];
    row_[next++] = feedback_.force_n[i];
  }
  actuators_record_->append(row_);
}

}  // namespace hybridtest
