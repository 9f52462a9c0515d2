#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "core/faults.hpp"
#include "core/interface_vector.hpp"
#include "core/messages.hpp"
#include "core/time.hpp"

namespace hybridtest {

/// Motion of the whole structure at one step, one entry per degree of freedom.
struct MotionState {
  Eigen::VectorXd displacement_m;
  Eigen::VectorXd velocity_m_per_s;
  Eigen::VectorXd acceleration_m_per_s2;
};

/// What a source of motion has for the coordinator.
enum class NextMotion : std::uint8_t {
  command,  // current() is to be imposed
  none,     // the program that leads has not asked for a force yet
  end,      // the program that leads has ended, or cannot go on
};

/// What a program that leads did, for the users.
struct LeadEvent {
  EventCode code = EventCode::none;
  ParticipantId subject;           // substructure that it is about; may be empty
  std::array<double, 2> values{};  // as the code defines them
};

/// Why a program that leads ended.
struct LeadEnd {
  StopReason reason = StopReason::none;
  LeadEvent event;  // without a code where the reason tells enough
};

/// Who says which displacement comes next: an integrator of ours, or a program that leads and asks for forces.
///
/// Each command waits for its restoring force; advance() takes it. After a command that was no trial the step is
/// complete.
class MotionSource {
 public:
  virtual ~MotionSource() = default;

  /// The command that waits for its restoring force. The displacement is the command; velocity and
  /// acceleration are predictions. At step 0 the initial state.
  [[nodiscard]] virtual const MotionState& current() const noexcept = 0;
  /// The step before, with velocity and acceleration as they are once its force is known. Not valid before the first
  /// advance().
  [[nodiscard]] virtual const MotionState& completed() const noexcept = 0;
  /// Trials of the step before the current command.
  [[nodiscard]] virtual int iteration() const noexcept { return 0; }
  /// Whether the current command is only tried: its force is wanted, from the state at the end of the step before, and
  /// the state stays there.
  [[nodiscard]] virtual bool is_trial() const noexcept { return false; }
  /// By how much the current command, which is no trial, still misses equilibrium because no more trials are allowed
  /// [m]; 0 when it does not.
  [[nodiscard]] virtual double missing_m() const noexcept { return 0.0; }
  /// @param restoring_force_n, applied_force_n   one entry per degree of freedom, of the current step.
  virtual void advance(const Eigen::Ref<const Eigen::VectorXd>& restoring_force_n,
                       const Eigen::Ref<const Eigen::VectorXd>& applied_force_n) noexcept = 0;

  // Of a program that leads. An integrator of ours always has a command.

  /// The first participant of a program that leads that is not there yet; empty when the test may begin.
  [[nodiscard]] virtual ParticipantId awaited(Instant) noexcept { return {}; }
  /// Takes what has arrived. Called while no command is open.
  [[nodiscard]] virtual NextMotion next(Instant) noexcept { return NextMotion::command; }
  /// When next() is to be called again although nothing arrives.
  [[nodiscard]] virtual Instant wake() const noexcept { return kNever; }
  /// The next event to tell, each once.
  [[nodiscard]] virtual std::optional<LeadEvent> take_event() noexcept { return std::nullopt; }
  /// After NextMotion::end.
  [[nodiscard]] virtual LeadEnd end() const noexcept { return {}; }
  /// Force of a substructure at the current command, before advance().
  virtual void take_force(SubstructureIndex, const InterfaceVector&) noexcept {}
};

}  // namespace hybridtest
