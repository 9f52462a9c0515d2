#pragma once

#include <cstdint>

#include "core/faults.hpp"
#include "core/messages.hpp"

namespace hybridtest {

/// From the site link to the control loop; a lock-free queue when they run on two threads.
struct LoopRequest {
  enum class Kind : std::uint8_t { arm, start, target, pause, resume, stop, emergency_stop };
  Kind kind = Kind::target;
  CommandPoint target;  // with `target`: the next step's point
};

/// A step's target reached and measured.
struct StepMeasurement {
  Step step = kNoStep;
  double model_time_s = 0.0;
  InterfaceVector target_displacement_m;    // [m]
  InterfaceVector imposed_displacement_m;   // [m] command to the actuators
  InterfaceVector measured_displacement_m;  // [m]
  InterfaceVector force_n;                  // [N] compensated
  MeasurementFlags flags = MeasurementFlags::none;
};

/// From the control loop to the site link.
struct LoopReport {
  /// `fault` ends the test; after a `warning` it goes on, if it holds as soon as that has `cleared`.
  enum class Kind : std::uint8_t { armed, arm_failed, zero_offset, measurement, warning, cleared, fault, at_rest };
  Kind kind = Kind::measurement;
  StepMeasurement measurement;          // with `measurement`
  FaultFlags fault = FaultFlags::none;  // with `fault` and `warning`: exactly one
  double observed = 0.0;                // likewise: in the fault's unit
  double limit = 0.0;
  int dof = 0;                  // with `zero_offset`
  double displacement_m = 0.0;  // likewise: what is taken off the measured displacement
  double force_n = 0.0;         // likewise
  double model_time_s = 0.0;
};

}  // namespace hybridtest
