#pragma once

#include <type_traits>
#include <variant>

#include "core/faults.hpp"
#include "core/messages.hpp"
#include "core/rig_fault.hpp"

/// What the site link and the control loop tell each other: variants, so that a message carries what
/// its kind needs and nothing else. They are passed through a lock-free queue when the link and the
/// loop run on two threads; copying one does not allocate.
namespace hybridtest {

namespace loop_request {

struct Arm {};
struct Start {};
/// The point of the next step.
struct Target {
  TargetPoint point;
};
/// In real time: the control periods are to be this much later than they would be by the site's clock alone, which
/// drifts against that of the coordinator.
struct ClockShift {
  Duration shift{};
};
struct Pause {};
struct Resume {};
struct Stop {};
struct EmergencyStop {};

}  // namespace loop_request

/// From the site link to the control loop.
using LoopRequest =
    std::variant<loop_request::Arm, loop_request::Start, loop_request::Target, loop_request::ClockShift,
                 loop_request::Pause, loop_request::Resume, loop_request::Stop, loop_request::EmergencyStop>;

/// The target of a step, reached and measured.
struct StepMeasurement {
  Step step = kNoStep;
  double model_time_s = 0.0;
  SiteVector target_displacement_m;    // [m]
  SiteVector imposed_displacement_m;   // [m] command to the actuators
  SiteVector measured_displacement_m;  // [m]
  SiteVector force_n;                  // [N] compensated
  MeasurementFlags flags = MeasurementFlags::none;
};

namespace loop_report {

struct Armed {};
/// The rig did not arm.
struct ArmFailed {
  RigFault fault = RigFault::did_not_arm;
};
/// Captured at arming for one interface degree of freedom; subtracted from what is measured.
struct ZeroOffset {
  int dof = 0;
  double displacement_m = 0.0;
  double force_n = 0.0;
};
/// An interlock that does not end the test.
struct Warning {
  FaultFlags fault = FaultFlags::none;  // exactly one
  double observed = 0.0;                // in the unit of the fault; what the two mean, see interlock_cause()
  double limit = 0.0;
  double model_time_s = 0.0;
};
/// What an interlock warned of or held for is over.
struct Cleared {
  double model_time_s = 0.0;
};
/// An interlock that ends the test.
struct Fault {
  FaultFlags fault = FaultFlags::none;  // exactly one
  double observed = 0.0;                // in the unit of the fault; what the two mean, see interlock_cause()
  double limit = 0.0;
  double model_time_s = 0.0;
};
/// The rig has stopped.
struct AtRest {};

}  // namespace loop_report

/// From the control loop to the site link.
using LoopReport = std::variant<loop_report::Armed, loop_report::ArmFailed, loop_report::ZeroOffset, StepMeasurement,
                                loop_report::Warning, loop_report::Cleared, loop_report::Fault, loop_report::AtRest>;

// The real-time path copies and visits them: neither may throw.
static_assert(std::is_nothrow_move_constructible_v<LoopRequest> && std::is_nothrow_move_assignable_v<LoopRequest>);
static_assert(std::is_nothrow_move_constructible_v<LoopReport> && std::is_nothrow_move_assignable_v<LoopReport>);

}  // namespace hybridtest
