#pragma once

#include "core/messages.hpp"
#include "hybridtest.h"
#include "transport/fast_dds/wire_mapping.hpp"

/// What the echoes send: messages as large as those of the coupled step.
namespace hybridtest::benchmarks {

/// For one interface degree of freedom, with its whole history.
[[nodiscard]] inline DisplacementCommand echo_command() {
  DisplacementCommand command;
  command.point_count = kCommandPoints;
  for (CommandPoint& point : command.points) {
    point.displacement_m = point.velocity_m_per_s = point.acceleration_m_per_s2 = InterfaceVector::Zero(1);
  }
  return command;
}

[[nodiscard]] inline ForceMeasurement echo_measurement() {
  ForceMeasurement measurement;
  measurement.imposed_displacement_m = measurement.measured_displacement_m = measurement.force_n =
      InterfaceVector::Zero(1);
  return measurement;
}

/// As it is on the network.
[[nodiscard]] inline wire::DisplacementCommand echo_command_sample() {
  wire::DisplacementCommand sample;
  fast_dds::encode(echo_command(), sample);
  return sample;
}

[[nodiscard]] inline wire::ForceMeasurement echo_measurement_sample() {
  wire::ForceMeasurement sample;
  fast_dds::encode(echo_measurement(), sample);
  return sample;
}

}  // namespace hybridtest::benchmarks
