#pragma once

#include <algorithm>
#include <cstdint>

#include "core/messages.hpp"

namespace hybridtest {

// Messages in which no two fields hold the same value, so that swapped fields show.

inline InterfaceVector counting_from(double first, int size) {
  InterfaceVector vector{size};
  for (int i = 0; i < size; ++i) vector[i] = first + i;
  return vector;
}

inline ScenarioDigest sample_digest() {
  ScenarioDigest digest{};
  for (std::size_t i = 0; i < digest.size(); ++i) digest[i] = static_cast<std::uint8_t>(7 * i + 1);
  return digest;
}

inline TestAnnouncement sample_announcement() {
  TestAnnouncement message{.test_name = "two_storey",
                           .coordinator = 0xfedcba9876543210ULL,
                           .scenario_digest = sample_digest(),
                           .mode = CouplingMode::paced,
                           .step_s = 0.001,
                           .duration_s = 31.0,
                           .time_scale = 20.0};
  message.substructures.push_back({.id = "storey_1", .role = Role::experimental_site, .interface_dofs = 1});
  message.substructures.push_back({.id = "storey_2", .role = Role::numerical_substructure, .interface_dofs = 12});
  return message;
}

inline ParticipantStatus sample_status(ParticipantId id, LifecycleState state = LifecycleState::running) {
  return {.id = id,
          .role = Role::experimental_site,
          .incarnation = 77,
          .state = state,
          .scenario_digest = sample_digest(),
          .last_step = 1234567890123,
          .faults = FaultFlags::force_limit | FaultFlags::participant_lost,
          .clock = Duration{-5}};
}

inline DisplacementCommand sample_command(SubstructureIndex substructure, Step step) {
  DisplacementCommand message{.substructure = substructure,
                              .coordinator = 42,
                              .iteration = 3,
                              .is_trial = true,
                              .point_count = 3,
                              .attempt = 9,
                              .send_time = Duration{987654321}};
  for (int i = 0; i < 3; ++i) {
    message.points[static_cast<std::size_t>(i)] = {.step = std::max(step - i, kNoStep),
                                                   .model_time_s = 100.0 + i,
                                                   .displacement_m = counting_from(1.5 + 100 * i, 12),
                                                   .velocity_m_per_s = counting_from(-20.25 + 100 * i, 3),
                                                   .acceleration_m_per_s2 = counting_from(40.125 + 100 * i, 1)};
  }
  return message;
}

inline ForceMeasurement sample_measurement(SubstructureIndex substructure, Step step) {
  return {.substructure = substructure,
          .sender = 4711,
          .step = step,
          .iteration = 6,
          .model_time_s = 2.5,
          .imposed_displacement_m = counting_from(0.5, 12),
          .measured_displacement_m = counting_from(50.5, 2),
          .force_n = counting_from(-1e6, 5),
          .flags = MeasurementFlags::extrapolated | MeasurementFlags::repeated,
          .receive_time = Duration{1},
          .send_time = Duration{2},
          .command_send_time = Duration{-3}};
}

inline TestControl sample_control() {
  return {.verb = ControlVerb::stop,
          .sender = 99,
          .sender_role = Role::coordinator,
          .reason = StopReason::participant_lost};
}

inline Event sample_event() {
  return {.source = "storey_1",
          .incarnation = 12,
          .severity = Severity::warning,
          .code = EventCode::command_overdue,
          .step = 17,
          .model_time_s = 0.017,
          .subject = "coordinator",
          .values = {0.5, -0.25},
          .clock = Duration{123}};
}

inline SignalBlock sample_signals() {
  SignalBlock message{
      .participant = "storey_1", .incarnation = 7, .group = "control", .part = 3, .sequence = 1U << 20U};
  for (std::size_t i = 0; i < kMaxLivePoints; ++i) message.model_time_s.push_back(0.05 * static_cast<double>(i));
  for (std::size_t k = 0; k < kMaxLiveSignals; ++k) {
    const std::vector<double> values(kMaxLivePoints, static_cast<double>(k) + 0.5);
    message.signals.push_back({.name = "displacement",
                               .subject = "floor_1",
                               .unit = "m",
                               .limit = 0.1,
                               .least = values,
                               .most = values,
                               .last = values});
  }
  return message;
}

}  // namespace hybridtest
