#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "experimental_site/geometry/setup_geometry.hpp"
#include "experimental_site/rigs/rig.hpp"

namespace hybridtest {

/// Makes a rig with actuator coordinates usable in interface degrees of freedom. Life cycle and threads
/// are those of the inner rig.
///
/// Faults in addition to those of the inner rig: a command beyond the stroke limit (the actuators go to the
/// limit), and measured strokes that no pose has (the feedback is then the last good one).
class TransformedRig final : public Rig {
 public:
  /// @param rig              in actuator coordinates; not null.
  /// @param geometry         not null.
  /// @param stroke_limit_m   [m] of every actuator from rest, either way; positive, infinity for none.
  TransformedRig(std::unique_ptr<Rig> rig, std::unique_ptr<SetupGeometry> geometry,
                 double stroke_limit_m = std::numeric_limits<double>::infinity());

  /// Columns of the table `rig_actuators`, one row per exchange().
  [[nodiscard]] static TableLayout actuators_layout(int actuators);
  void record_to(const RigTables& tables) override;

  void connect() override;
  void arm() override { rig_->arm(); }
  [[nodiscard]] RigStatus exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept override;
  [[nodiscard]] RigFault fault() const noexcept override { return fault_.value_or(rig_->fault()); }
  void stop_motion() noexcept override { rig_->stop_motion(); }

 private:
  [[nodiscard]] bool limit_strokes() noexcept;
  void record() noexcept;

  std::unique_ptr<Rig> rig_;
  std::unique_ptr<SetupGeometry> geometry_;
  double stroke_limit_m_;
  RowSink* actuators_record_ = nullptr;
  std::vector<double> row_;
  ActuatorCommand command_;        // in actuators
  RigFeedback feedback_;           // in actuators
  SiteVector pose_;                // measured
  std::optional<RigFault> fault_;  // of the geometry; otherwise the inner rig has it
};

}  // namespace hybridtest
