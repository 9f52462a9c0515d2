#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "experimental_site/rigs/rig.hpp"

namespace hybridtest {

/// A rig made of a lambda that keeps the commands it received.
class ScriptedRig final : public Rig {
 public:
  using Answer = std::function<RigStatus(const ActuatorCommand& command, RigFeedback& feedback)>;

  explicit ScriptedRig(Answer answer) : answer_{std::move(answer)} {}

  void connect() override {}
  void arm() override {
    if (on_arm) on_arm();
    is_armed = true;
  }
  [[nodiscard]] RigStatus exchange(const ActuatorCommand& command, RigFeedback& feedback) noexcept override {
    commands.push_back(command);
    return answer_(command, feedback);
  }
  void stop_motion() noexcept override { ++stops; }

  std::function<void()> on_arm;  // may throw
  bool is_armed = false;
  int stops = 0;
  std::vector<ActuatorCommand> commands;

 private:
  Answer answer_;
};

/// Follows its command at once and measures a spring.
[[nodiscard]] inline ScriptedRig::Answer ideal_spring_rig(double stiffness_n_per_m) {
  return [stiffness_n_per_m](const ActuatorCommand& command, RigFeedback& feedback) {
    feedback.displacement_m = command.displacement_m;
    feedback.force_n = stiffness_n_per_m * command.displacement_m;
    return RigStatus::healthy;
  };
}

}  // namespace hybridtest
